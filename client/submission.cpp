#include "client/submission.h"

#include <filesystem>

#include "client/outcome.h"
#include "proto/status.h"
#include "scenes/check.h"
#include "scenes/needs.h"
#include "scenes/parser.h"

namespace penumbra {

std::vector<std::string> warnings_of(const SceneDescription& scene, const SceneDefaults& defaults) {
  std::vector<std::string> warnings = scene.warnings;
  const std::vector<std::string> left_out = unsupported(scene);
  warnings.insert(warnings.end(), left_out.begin(), left_out.end());
  warnings.insert(warnings.end(), defaults.notes.begin(), defaults.notes.end());
  return warnings;
}

absl::StatusOr<Submission> prepare(const JobOptions& options) {
  ASSIGN_OR_RETURN(const SceneDescription scene, parse_scene_file(options.scene));
  const FolderFiles files(std::filesystem::path(options.scene).parent_path());
  RETURN_IF_ERROR(check_files(scene, files));
  ASSIGN_OR_RETURN(const SceneDefaults defaults, scene_defaults(scene));
  Submission submission;
  ASSIGN_OR_RETURN(submission.spec, make_job(options, defaults));
  submission.warnings = warnings_of(scene, defaults);
  if (submission.spec.strict && !submission.warnings.empty())
    return invalid_input("{} (--strict)", submission.warnings[0]);
  if (!submission.spec.reference.empty()) RETURN_IF_ERROR(read_reference(submission.spec).status());
  ASSIGN_OR_RETURN(submission.bundle, make_bundle(options.scene, scene));
  submission.spec.bundle = sha256(serialize(submission.bundle.index));
  return submission;
}

absl::StatusOr<Submission> prepare_again(const JobSpec& spec) {
  ASSIGN_OR_RETURN(const SceneDescription scene, parse_scene_file(spec.scene));
  Submission submission;
  submission.spec = spec;
  ASSIGN_OR_RETURN(submission.bundle, make_bundle(spec.scene, scene));
  const Digest digest = sha256(serialize(submission.bundle.index));
  if (digest != spec.bundle)
    return invalid_input("{}: the scene's files have changed since the run (bundle {:.12}, then {:.12})",
                         spec.scene, digest, spec.bundle);
  return submission;
}

}  // namespace penumbra
