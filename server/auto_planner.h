#pragma once
// From a pilot's measurements to what `auto` does in each tile. Pure.
//
// The error of the image is Σ_t V_t / N_t, with V_t the sum over a tile's pixels and channels of
// s² / (mean² + ε) of one pass, and N_t its passes; its cost is Σ_t C_t N_t. Neyman's allocation,
// N_t ∝ √(V_t / C_t), has the least error at any cost: (Σ_t √(V_t C_t))² / cost. So a tile takes the
// candidate with the least V C, and then the passes that follow. Within a tile the same goes for its blocks
// (server/auto_blocks.h).
#include <vector>

#include "absl/status/statusor.h"
#include "proto/auto_plan.h"
#include "proto/job.h"

namespace penumbra {

/// Blocks of pixels that the pilot of a tile should measure, at most: what the budget allows.
int pilot_blocks(const JobSpec& spec, const PixelRect& tile);

/// What is known of a mix's spending besides its pilot.
struct AutoSpending {
  double factor = 1;                ///< seconds now per second of the pilot
  double repilot_seconds = 0;       ///< what repeating parts of the pilot takes of the budget
  std::vector<int64_t> least = {};  ///< passes that each tile has in any case; empty: none
};

/// The plan of the job's automatic mix number `number` among them. `pilot[tile]` are the costs of the pilot
/// tasks: one per mix of the job (of an automatic mix: whole passes of one of its candidates, where there
/// were any), then one per candidate of each automatic mix. CPU seconds S: the passes that, by the pilot's
/// costs, take S less what the pilot and its repetitions take; at least one each, and at least what is
/// rendered already. Target error E: the passes that bring Σ_t V_t / N_t down to E times pixels and channels;
/// at least two each. Passes: as many in every tile; costs are counted work instead of seconds. Internal if a
/// pilot has measured nothing.
absl::StatusOr<AutoPlan> plan_auto(const JobSpec& spec, const std::vector<PixelRect>& tiles,
                                   const std::vector<std::vector<MixCost>>& pilot, size_t number,
                                   const AutoSpending& spending = {});

/// Seconds of the pilot (with a budget of passes: units of work) for a pass of what each tile does in that
/// plan, with its blocks' shares.
absl::StatusOr<std::vector<double>> auto_pass_costs(const JobSpec& spec, const std::vector<PixelRect>& tiles,
                                                    const std::vector<std::vector<MixCost>>& pilot,
                                                    size_t number);

}  // namespace penumbra
