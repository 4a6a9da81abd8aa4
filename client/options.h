#pragma once
// The options that several subcommands share, as they were typed, and what they mean for a scene.
#include <CLI/App.hpp>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "client/scene_defaults.h"
#include "proto/channel.h"
#include "proto/job.h"

namespace penumbra {

/// Where the server is.
struct ServerOptions {
  std::string address;
  Credentials credentials;
};
/// `from_environment`: PENUMBRA_SERVER stands in for --server. Where a local cluster stands in for it
/// instead, certificates and a token without --server are refused: nobody would ask for them.
void add_server_options(CLI::App& app, ServerOptions& options, bool from_environment);

/// The local cluster of render and replay, when no --server is given.
struct ClusterOptions {
  std::string workers, threads;
};
void add_cluster_options(CLI::App& app, ClusterOptions& options);
struct ClusterSize {
  int workers = 2;
  int threads = 1;  ///< of each worker
};
/// Defaults: 2 workers, threads = cores / workers, at least 1.
absl::StatusOr<ClusterSize> cluster_size(const ClusterOptions& options, int cores);

/// What to render. Text is kept as typed, so that every fault can name its flag and the scene's defaults
/// are known before anything is decided. Empty: not given.
struct JobOptions {
  std::string scene;
  std::vector<std::string> mixes, regions;
  std::string budget, passes, target_error;
  std::string sampler, resolution, crop, max_depth, tile, camera_grid, seed;
  std::string reference, transient;
  bool strict = false;
};
void add_job_options(CLI::App& app, JobOptions& options);

/// The first of these options that was typed, or "": for those that would have no meaning beside others.
std::string first_given(const CLI::App& app, const std::vector<std::string>& flags);
/// The options of add_job_options.
std::vector<std::string> job_flags();

/// Empty text means «not given» in the structures here; typed, as a script's unset variable, it is a fault.
void refuse_empty_values(CLI::App& app);

/// The job for this scene; `bundle` is left empty. InvalidArgument names the flag at fault.
absl::StatusOr<JobSpec> make_job(const JobOptions& options, const SceneDefaults& scene);

/// How to tell the outcome.
struct OutputOptions {
  std::string out;
  bool json = false, quiet = false;
};
void add_output_options(CLI::App& app, OutputOptions& options);

/// `./penumbra-out/<scene>`, the scene's file name without its extension.
std::string default_folder(const std::string& scene);

}  // namespace penumbra
