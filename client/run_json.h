#pragma once
// run.json: what a run was, what it cost, how good it is.
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "client/checkpoint_errors.h"
#include "client/job_json.h"
#include "film/metrics.h"
#include "film/own_error.h"
#include "proto/run.h"

namespace penumbra {

/// What the client adds to the server's figures of one mix.
struct MixRecord {
  std::string label;  ///< with `#2` where a mix is repeated
  std::string image;  ///< file name in the run's folder
  std::optional<ErrorFigures> error;
  std::vector<std::pair<std::string, ErrorFigures>> regions;
  std::optional<OwnError> own_error;         ///< of the final image
  std::vector<CheckpointError> checkpoints;  ///< parallel to MixSummary::checkpoints; may be shorter
};

struct RunRecord {
  RunSummary summary;
  double scheduler_cpu_seconds = 0;
  std::vector<MixRecord> mixes;
  bool partial = false;  ///< interrupted: images hold what was accepted until then
};

/// The run as the interface's schema 1, and more keys: `partial`, `state`, `reference`, `plan` (passes per
/// mix), `auto_plans` and `earlier_plans` (client/auto_plan_json.h), `spec` (enough to replay), `warnings`,
/// `tiles`, `workers`, times of the phases; for `gate` the `calibration` (proto/job.h) of run, mixes and
/// tiles, each mix's `relative_variance` (ErrorFigures::variance), and its `error_blocks`: relMSE and
/// variance of every block of a grid over the crop, row by row, `edge` pixels wide. `estimated_relmse` and
/// its interval, of the final image and along the timeline: what relMSE the run itself expects
/// (film/own_error.h). `transient` is {"t0","t1","bins"} of a job with --transient. Figures that do not apply
/// are null.
Json run_json(const RunRecord& run);

/// The job that renders the same bits again: the spec with the run's plan. InvalidArgument for a run.json
/// without one (a run that ended before it was planned).
absl::StatusOr<JobSpec> replay_spec(const Json& run);

/// Reads a JSON file; InvalidArgument with path and position.
absl::StatusOr<Json> read_json(const std::string& path);
/// As it stands in files and on standard output: two blanks of indentation, newline at the end.
std::string json_text(const Json& json);

}  // namespace penumbra
