#pragma once
// Passes where they are wanted within a tile. Pure.
//
// A tile's error is Σ_b V_b / n_b over its blocks, its cost Σ_b C_b n_b, so n_b ∝ √(V_b / C_b) as among tiles
// (server/auto_planner.h). With the largest of these as the tile's passes N and r_b = n_b / N, a pass of the
// tile costs Σ_b C_b r_b and leaves Σ_b V_b / r_b: what the tile's neighbours are weighed against, whose
// passes then come out in proportion to their blocks' own √(V_b / C_b), as if there were no tiles.
#include <cstdint>
#include <vector>

#include "proto/job.h"

namespace penumbra {

struct SharedOut {
  std::vector<uint8_t> shares;  ///< TilePlan::shares; empty where blocks are too much alike to gain from them
  double error = 1, cost = 1;   ///< of a pass of the tile, over what they are if all blocks have a part in it
};

/// Sum over the tile's pixels of their squared deviations, as far as means over blocks tell it: less than the
/// sum of their variances, but far better known from few passes. 0 if nothing was measured.
double squared_deviations(const PixelRect& tile, const std::vector<BlockCost>& blocks);

/// No block has less than this share of the passes of the one with the most.
inline constexpr double kLeastBlockShare = 0.25;

/// From what a pilot has measured in each block of the tile; no shares if it has not. No share is below
/// `least`, which lies in [kLeastBlockShare, 1].
SharedOut shared_out(const PixelRect& tile, const std::vector<BlockCost>& blocks,
                     double least = kLeastBlockShare);

}  // namespace penumbra
