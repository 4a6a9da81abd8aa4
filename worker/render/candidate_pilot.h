#pragma once
// What `auto` wants to know of a tile: variance and cost of each candidate mix, from small blocks of pixels.
#include <atomic>
#include <vector>

#include "worker/render/pixel_sampler.h"

namespace penumbra {

/// Measures the candidates of one automatic mix (all of `chosen`, which share one place in the job) on up to
/// task.pilot_blocks blocks of pixels, spread evenly over the tile; with pilot_seconds > 0 no further block
/// is begun once these are spent. Every candidate sees the same blocks with the same camera samples. One cost
/// per candidate, without passes for one with lines where no light, or no medium, serves lines; empty if
/// cancelled.
std::vector<MixCost> measure_candidates(const Rendering& rendering, const TileTask& task,
                                        const std::vector<ChosenMix>& chosen,
                                        const std::atomic<bool>& cancel);

}  // namespace penumbra
