#pragma once
// From the pilot's work, repeated within the run, to totals that spend the budget. Pure.
//
// Between the passes that are kept, a small share of passes has the pilot's random numbers; they are timed
// and thrown away. Their time over what the pilot's figures foretold for them is what a pass costs now: the
// machine's mood, and for `auto` also what blocks did not tell of whole tiles. The kept samples have no say:
// what is planned depends on nothing that depends on them, and the image stays unbiased.
#include <functional>
#include <vector>

#include "absl/status/statusor.h"
#include "server/planner.h"

namespace penumbra {

/// Passes of the pilot that a run task repeats: one range per mix; none where nothing is planned from it.
std::vector<PassRange> repilot_of(const JobSpec& spec, const Plan& plan, uint64_t range, uint64_t tile);

/// What they are expected to take of each mix's budget, before anything is known.
double expected_repilot_seconds(const JobSpec& spec);

/// What the repeated passes say of some mixes.
struct Speed {
  int64_t passes = 0;
  double seconds = 0, foretold = 0;  ///< of these passes
  /// Seconds now per second of the pilot. Few passes are noisy by about as much as machines drift: what would
  /// be believed without them counts as `worth` more of them.
  double factor(double otherwise = 1, double worth = 1) const;
};

/// Costs of the run task with this index; null if its result is not here.
using CostsOf = std::function<const std::vector<MixCost>*(uint64_t)>;

/// The plan after the next open border: S = (passes × pilot's seconds per pass) × factor, with a factor for
/// each mix. Mixes that are not automatic drift alike, and the pilot knows their ratio: their factors are
/// drawn towards what all of them say together. Of `auto` the budget also pays pilot and repeated passes.
/// Nowhere fewer passes than are rendered at the border. Requires an open border. Internal if a pilot has
/// measured nothing.
absl::StatusOr<PlannedPasses> replanned(const JobSpec& spec, const std::vector<std::vector<MixCost>>& pilot,
                                        const PlannedPasses& planned, const CostsOf& costs);

}  // namespace penumbra
