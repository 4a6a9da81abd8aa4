#pragma once
// What the pilot of an automatic mix has measured, in the planner's terms. Pure.
#include <vector>

#include "absl/status/statusor.h"
#include "proto/job.h"

namespace penumbra {

/// What the pilot says of the candidates in each tile, per pixel. Row per tile, column per candidate that was
/// measured.
using Table = std::vector<std::vector<double>>;

struct Measurements {
  std::vector<int> candidates;  ///< places in auto_candidates()
  Table variance;               ///< mean of s² / (mean² + ε), summed over channels
  Table worth;     ///< how many pixels that mean is worth, (Σx)² / Σx²: one, if one outshines the rest
  Table measured;  ///< how many pixels were measured
  std::vector<bool> lobed;  ///< per tile: something there scatters light into a narrow lobe
  Table cost;               ///< per pass: seconds, or units of work
  std::vector<std::vector<BlockCost>> blocks;  ///< per tile; none where there were less than two whole passes
  double pilot_seconds = 0;
};

/// Of the job's automatic mix number `number` among them; `pilot[tile]` as in plan_auto. Internal if a pilot
/// has measured nothing.
absl::StatusOr<Measurements> measurements(const JobSpec& spec, const std::vector<PixelRect>& tiles,
                                          const std::vector<std::vector<MixCost>>& pilot, size_t number);

}  // namespace penumbra
