#pragma once
// From a scene file and options to a job that a server can take.
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "client/options.h"
#include "scenes/bundle.h"

namespace penumbra {

/// What is to be said about a scene before it is rendered: of its text, of what is read but not rendered,
/// of its defaults.
std::vector<std::string> warnings_of(const SceneDescription& scene, const SceneDefaults& defaults);

struct Submission {
  JobSpec spec;
  LocalBundle bundle;
  std::vector<std::string> warnings;
};

/// Parses the scene, decides the job, checks the reference, collects the files: everything that can be
/// wrong with the input is said here, before a server is asked.
absl::StatusOr<Submission> prepare(const JobOptions& options);

/// For a job that is known already: parses and collects its scene again. InvalidArgument if the scene's
/// files are not the ones that the job was rendered from.
absl::StatusOr<Submission> prepare_again(const JobSpec& spec);

}  // namespace penumbra
