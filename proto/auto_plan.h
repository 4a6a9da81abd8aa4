#pragma once
// The `auto` mix in the words that client, server and worker share: which candidates there are, and what
// a plan must hold to belong to a job.
#include <vector>

#include "absl/status/status.h"
#include "proto/job.h"

namespace penumbra {

/// What `auto` chooses from, in the order of their numbers. A pilot leaves out those that a scene has no use
/// for: lines where no light serves them, medium=line without media and a light at hand. Lines
/// of the lens and of time are none of them: what they cost is more than they bring
/// (worker/effects/README.md).
const std::vector<Mix>& auto_candidates();

/// How many of them any scene may use.
size_t common_candidates();

/// Whether f / p is bounded, because directions are also drawn from the material's lobes. Of any other mix a
/// few samples cannot tell what it does where a lobe is narrow.
bool is_bounded(const Mix& mix);

/// Places of the automatic mixes.
std::vector<int> automatic_mixes(const std::vector<Mix>& mixes);

/// InvalidArgument unless there is no plan at all, or one for each automatic mix, in their order.
absl::Status check_auto_plans(const std::vector<AutoPlan>& plans, const std::vector<Mix>& mixes);

/// Borders ascend within (0,1); counts are one per mix, and lists of tiles one per automatic mix.
absl::Status check_earlier_plans(const std::vector<EarlierPlan>& plans, const std::vector<Mix>& mixes);

}  // namespace penumbra
