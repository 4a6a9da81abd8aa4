#pragma once
// A run for CPU seconds in stages. A pilot at the start cannot know what a second will be worth later: shared
// machines drift by a tenth and more within seconds. So only part of the run is given out at first; the
// totals are planned anew, twice, from the pilot's own work repeated within the run (server/replanner.h).
// Pure.
//
//   share of the passes  0 ────────── 1/2 ────── 3/4 ────── 7/8 ────── 1
//   planned by           the pilot ············· |          |
//                        what was repeated in [0, 1/2) ···· |
//                        what was repeated in [0, 3/4) ···············
//
// What is planned anew begins one border after what it was measured on: cores have work while the last
// results of a stage come in.
#include <cstdint>
#include <vector>

#include "absl/status/status.h"
#include "proto/job.h"
#include "proto/tiles.h"

namespace penumbra {

/// Passes per mix, the plans of the automatic ones (server/auto_planner.h), and how they came to be.
struct PlannedPasses {
  std::vector<int64_t> passes;  ///< of an automatic mix: the mean over the pixels, rounded, at least 1
  std::vector<AutoPlan> autos;
  std::vector<EarlierPlan> earlier = {};  ///< what was planned in the stages before
  std::vector<double> open = {};          ///< borders at which the plan will be looked at again, ascending
  bool operator==(const PlannedPasses&) const = default;
};

/// Where stages end: passes up to there are sure from the beginning, or from the border before.
inline constexpr double kStageBorders[] = {3 / 4., 7 / 8.};
/// What the first border's decision is made on; the next one's: what was rendered up to the border before it.
inline constexpr double kFirstMeasured = 1 / 2.;

/// Borders of a job that is about to be planned: none unless it is for CPU seconds, without a stored plan.
std::vector<double> borders_of(const JobSpec& spec);

/// The share of the passes that must be rendered before the next open border's decision; requires one.
double measured_share(const std::vector<EarlierPlan>& earlier);

/// Up to the share `until` passes go straight for `total`.
struct Stage {
  double until = 1;
  int64_t total = 0;
};

/// Of a mix that has the same passes in all pixels.
std::vector<Stage> stages_of(const PlannedPasses& planned, size_t mix);
/// Of one tile of the automatic mix number `automatic` among them.
std::vector<Stage> stages_of(const PlannedPasses& planned, size_t automatic, size_t tile);

/// Passes at a share of the run. Whole groups but for the end; the nearest number of them, at a border the
/// next below (groups may be large: what is rounded up there could be more than the next plan wants). Ascends
/// with the share as long as totals do not lie below what the stage before has rendered (check_stages).
int64_t passes_at(double share, const std::vector<Stage>& stages, int64_t group);

}  // namespace penumbra
