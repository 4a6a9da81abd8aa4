#include "client/run_job.h"

#include <algorithm>
#include <thread>

#include "client/outcome.h"
#include "client/output_folder.h"
#include "client/preview.h"
#include "client/progress.h"
#include "client/quiet_run.h"
#include "proto/status.h"

namespace penumbra {
namespace {

/// What the workers found in the scene that the client's own reading did not.
void tell_new_warnings(const Json& run, const std::vector<std::string>& told, Progress& progress) {
  constexpr int kMostLines = 20;
  int lines = 0;
  for (const Json& warning : run["warnings"]) {
    const auto text = warning.get<std::string>();
    if (std::find(told.begin(), told.end(), text) != told.end()) continue;
    if (++lines <= kMostLines) progress.note("warning: " + text);
  }
  if (lines > kMostLines) progress.note(fmt::format("{} more warnings in run.json", lines - kMostLines));
}

}  // namespace

absl::StatusOr<std::unique_ptr<Backend>> open_backend(const ServerOptions& options,
                                                      const ClusterOptions& cluster) {
  if (!options.address.empty()) {
    auto backend = std::make_unique<Backend>();
    if (!cluster.workers.empty() || !cluster.threads.empty())
      return invalid_input(
          "--workers and --threads are for a local cluster; with --server they have no meaning");
    ASSIGN_OR_RETURN(Server server, Server::open(options.address, options.credentials));
    backend->server.emplace(std::move(server));
    return backend;
  }
  return open_local(cluster, "");
}

absl::StatusOr<std::unique_ptr<Backend>> open_local(const ClusterOptions& cluster,
                                                    const std::string& programs) {
  auto backend = std::make_unique<Backend>();
  const auto cores = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  ASSIGN_OR_RETURN(const ClusterSize size, cluster_size(cluster, cores));
  ASSIGN_OR_RETURN(LocalCluster local, LocalCluster::start(size, programs));
  backend->cluster.emplace(std::move(local));
  LocalCluster* const tended = &*backend->cluster;
  ASSIGN_OR_RETURN(Server server, Server::open(tended->address(), {}, [tended] { return tended->tend(); }));
  backend->server.emplace(std::move(server));
  return backend;
}

absl::StatusOr<FinishedRun> run_job(Backend& backend, const Submission& submission, const std::string& folder,
                                    bool quiet, std::stop_token stop, const std::string& display) {
  RETURN_IF_ERROR(prepare_folder(folder));
  RETURN_IF_ERROR(check_reference_stays(submission.spec, folder));
  Server& server = *backend.server;
  std::optional<Tev> tev;
  if (!display.empty()) {
    ASSIGN_OR_RETURN(Tev connected, Tev::connect(display));
    tev.emplace(std::move(connected));
  }
  Progress progress(Progress::style_for(quiet));
  for (const std::string& warning : submission.warnings) progress.note("warning: " + warning);
  RETURN_IF_ERROR(server.upload(submission.bundle, stop,
                                [&](uint64_t sent, uint64_t total) { progress.uploading(sent, total); }));
  ASSIGN_OR_RETURN(const JobId job, server.submit(submission.spec, stop));

  FinishedRun finished;
  std::optional<Preview> preview;
  if (tev) preview.emplace(server, job, *std::move(tev));
  const auto each = [&](const JobStatus& status) {
    progress.show(status);
    return backend.tend();
  };
  absl::StatusOr<JobStatus> watched = server.watch(job, stop, each);
  finished.interrupted = watched.status().code() == absl::StatusCode::kCancelled && stop.stop_requested();
  if (finished.interrupted) {
    progress.note("interrupted: cancelling the job and keeping what was rendered");
    watched = server.cancel(job);
  }
  progress.clear();
  preview.reset();
  RETURN_IF_ERROR(watched.status());
  finished.last = *watched;
  const bool done = finished.last.state == JobState::kDone;
  if (!done && finished.last.plan.empty()) {  // nothing was rendered
    if (finished.interrupted) return absl::CancelledError("interrupted before anything was rendered");
    return failure_of(finished.last);
  }
  ASSIGN_OR_RETURN(finished.run, write_outcome(server, job, folder, !done, std::stop_token()));
  tell_new_warnings(finished.run, submission.warnings, progress);
  if (!done && !finished.interrupted) return failure_of(finished.last);
  return finished;
}

}  // namespace penumbra
