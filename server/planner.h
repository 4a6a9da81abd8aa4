#pragma once
// From a job to tile tasks. Pure: a plan is a function of (spec, passes per mix) alone, never of worker
// counts or clocks, because the bits of the image depend on groups and on the order of merges.
#include <cstdint>
#include <vector>

#include "absl/status/statusor.h"
#include "proto/job.h"

namespace penumbra {

/// The job's tiles, row by row from the crop's upper left corner; those at the right and bottom edges may
/// be smaller.
std::vector<PixelRect> tiles_of(const JobSpec& spec);

/// Whether pass counts must be measured first: a CPU-seconds or target-error budget without stored plan.
bool needs_pilot(const JobSpec& spec);

/// Pilot task of tile `index`; its id is the index.
TileTask pilot_task(const JobSpec& spec, const std::vector<PixelRect>& tiles, uint64_t index);

/// Passes per mix. `pilot[tile][mix]` are the costs of all pilot tasks; empty where needs_pilot is false.
/// CPU seconds S: N = max(1, round(S / Σ_tiles seconds per pass)).
/// Target error E: N = max(2, ceil(mean over pixels and channels of s²/(mean² + 1e-2) / E)), because the
/// relMSE of an unbiased estimate with N passes is its one-pass value over N.
/// Internal if a pilot has measured nothing.
absl::StatusOr<std::vector<int64_t>> planned_passes(const JobSpec& spec,
                                                    const std::vector<std::vector<MixCost>>& pilot);

/// The end of one range of passes, common to all tiles.
struct PassBoundary {
  std::vector<int64_t> passes;  ///< cumulative, one per mix
  bool checkpoint = false;      ///< a point of the error-against-time timeline
  bool operator==(const PassBoundary&) const = default;
};

struct Plan {
  std::vector<int64_t> passes;           ///< per mix
  int64_t group = 1;                     ///< passes per independently scrambled group
  std::vector<PassBoundary> boundaries;  ///< ascending; the last has all passes and is a checkpoint
  bool operator==(const Plan&) const = default;
};

Plan make_plan(const JobSpec& spec, const std::vector<int64_t>& passes);

/// Number of run tasks: ranges × tiles.
uint64_t task_count(const Plan& plan, const std::vector<PixelRect>& tiles);

/// Run task `index`, range-major: all tiles of the first range come first, so that a whole picture is
/// there soon. Its id is first_id + index; ids are the order of merging.
TileTask run_task(const JobSpec& spec, const Plan& plan, const std::vector<PixelRect>& tiles,
                  uint64_t first_id, uint64_t index);

}  // namespace penumbra
