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

/// What was planned of a run in stages before its last plan, without which that cannot be replayed: one
/// object per stage, {"until": share of all passes, "passes": [per mix], "autos": [per automatic mix: [per
/// tile]]}.
Json earlier_plans_json(const std::vector<EarlierPlan>& plans);
/// InvalidArgument as above.
absl::StatusOr<std::vector<EarlierPlan>> earlier_plans_from_json(const Json& json, const JobSpec& spec);

}  // namespace penumbra
