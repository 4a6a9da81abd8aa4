#pragma once
// From a job to tile tasks. Pure: a plan is a function of (spec, passes per mix) alone, never of worker
// counts or clocks, because the bits of the image depend on groups and on the order of merges.
#include <cstdint>
#include <vector>

#include "absl/status/statusor.h"
#include "proto/job.h"
#include "proto/tiles.h"
#include "server/stages.h"

namespace penumbra {

/// Whether something must be measured first: for pass counts (a CPU-seconds or target-error budget), or for
/// what an `auto` chooses; not with a stored plan.
bool needs_pilot(const JobSpec& spec);

/// Pilot task of tile `index`; its id is the index.
TileTask pilot_task(const JobSpec& spec, const std::vector<PixelRect>& tiles, uint64_t index);

/// Costs that a task must report: one per mix, and after them, for a pilot, one per candidate.
size_t costs_of(const TileTask& task);

/// `pilot[tile]` are the costs of all pilot tasks; empty where needs_pilot is false. Of a mix that is not
/// automatic:
/// CPU seconds S: N = max(1, round(S / Σ_tiles seconds per pass)).
/// Target error E: N = max(2, ceil(mean over pixels and channels of s²/(mean² + 1e-2) / E)), because the
/// relMSE of an unbiased estimate with N passes is its one-pass value over N.
/// Internal if a pilot has measured nothing.
absl::StatusOr<PlannedPasses> planned_passes(const JobSpec& spec,
                                             const std::vector<std::vector<MixCost>>& pilot);

/// Of one mix that is not automatic; `factor`: seconds now per second of the pilot.
absl::StatusOr<int64_t> passes_for_seconds(double budget, const std::vector<std::vector<MixCost>>& pilot,
                                           size_t mix, double factor = 1);

/// Passes of an automatic mix: the mean over the pixels, as its blocks share in them, rounded, at least 1.
/// Before it is known in which groups; what a plan's boundaries say is exact.
int64_t mean_passes(const JobSpec& spec, const std::vector<PixelRect>& tiles, const AutoPlan& plan);

/// The end of one range of passes, common to all tiles.
struct PassBoundary {
  std::vector<int64_t> passes;  ///< cumulative, one per mix; of an automatic mix the mean over the pixels
  bool checkpoint = false;      ///< a point of the error-against-time timeline
  double share = 1;             ///< of all passes: how far the tiles of automatic mixes are
  bool operator==(const PassBoundary&) const = default;
};

struct Plan {
  PlannedPasses planned;
  std::vector<std::vector<int64_t>> groups;  ///< per automatic mix and tile: passes per scrambled group
  int64_t group = 1;                         ///< passes per independently scrambled group of the others
  std::vector<PassBoundary> boundaries;      ///< ascending; the last has all passes and is a checkpoint
  uint64_t tiles = 0;                        ///< of the job
  /// Ranges that are sure; those after them change when the plan is looked at again.
  uint64_t sure = 0;
  /// Ranges that must be done before it is; meaningless without an open border.
  uint64_t measured = 0;
  bool operator==(const Plan&) const = default;
};

/// `autos`: one for each automatic mix, with a plan for each tile. Whatever is planned at the open borders,
/// the ranges up to the first of them stay what they are.
Plan make_plan(const JobSpec& spec, const PlannedPasses& planned);
inline Plan make_plan(const JobSpec& spec, const std::vector<int64_t>& passes,
                      const std::vector<AutoPlan>& autos = {}) {
  return make_plan(spec, PlannedPasses{passes, autos});
}

/// InvalidArgument if a stage's totals lie below what the one before has rendered, or are not for these
/// tiles.
absl::Status check_stages(const JobSpec& spec, const PlannedPasses& planned);

/// Number of run tasks: ranges × tiles.
uint64_t task_count(const Plan& plan, const std::vector<PixelRect>& tiles);

/// Passes of a mix in one tile and range.
PassRange run_range(const Plan& plan, uint64_t range, uint64_t tile, size_t mix);

/// Run task `index`, range-major: all tiles of the first range come first, so that a whole picture is
/// there soon. Its id is first_id + index; ids are the order of merging.
TileTask run_task(const JobSpec& spec, const Plan& plan, const std::vector<PixelRect>& tiles,
                  uint64_t first_id, uint64_t index);

}  // namespace penumbra
