#pragma once
// The pilot of `auto` in one tile: what its candidates cost and leave, and what varies where.
#include <atomic>
#include <vector>

#include "worker/render/pixel_sampler.h"

namespace penumbra {

/// Measures the candidates of the task's automatic mixes (candidate_pilot.h) and appends their costs to
/// `costs`, in the task's order. Then one of them makes whole passes of the tile; what they cost, and with
/// two or more what varies in each block, goes to the automatic mix's own place in `costs`. False: cancelled.
bool run_auto_pilot(const Rendering& rendering, const TileTask& task, const std::atomic<bool>& cancel,
                    std::vector<MixCost>& costs);

}  // namespace penumbra
