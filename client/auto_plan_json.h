#pragma once
// The plans of a run's `auto` mixes as they stand in run.json, for the report and for `replay`.
#include <vector>

#include "client/job_json.h"

namespace penumbra {

/// One object per automatic mix: {"mix": place among the run's mixes, "candidates": [labels], "tiles":
/// [{"rect", "candidate": place in candidates, "mix": its label, "passes"}, …] row by row}.
Json auto_plans_json(const JobSpec& spec, const std::vector<AutoPlan>& plans);

/// Reads `candidates`, `mix` and each tile's `candidate` and `passes`; the rest is for people.
/// InvalidArgument names the key at fault, or says that the plans do not belong to this job.
absl::StatusOr<std::vector<AutoPlan>> auto_plans_from_json(const Json& json, const JobSpec& spec);

}  // namespace penumbra
