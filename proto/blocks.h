#pragma once
// How an automatic mix shares out the passes of a tile among small blocks of its pixels: where little varies
// a block sits some of them out. Pure arithmetic that planner, worker and film have in common.
#include <cstdint>
#include <vector>

#include "proto/job.h"

namespace penumbra {

/// Edge of a block in pixels, counted from the tile's upper left corner; those at its right and bottom edges
/// may be smaller.
constexpr int kBlock = 8;
/// The share of a block that has a part in every pass.
constexpr int kWholeShare = 255;

inline int block_columns(const PixelRect& tile) {
  return (tile.width() + kBlock - 1) / kBlock;
}
inline size_t block_count(const PixelRect& tile) {
  return static_cast<size_t>(block_columns(tile)) *
         static_cast<size_t>((tile.height() + kBlock - 1) / kBlock);
}
/// Number of the block, row by row, that holds an absolute pixel of the tile.
inline size_t block_of(const PixelRect& tile, int x, int y) {
  return static_cast<size_t>((y - tile.y0) / kBlock) * static_cast<size_t>(block_columns(tile)) +
         static_cast<size_t>((x - tile.x0) / kBlock);
}
inline PixelRect block_rect(const PixelRect& tile, size_t block) {
  const auto columns = static_cast<size_t>(block_columns(tile));
  const int x0 = tile.x0 + kBlock * static_cast<int>(block % columns);
  const int y0 = tile.y0 + kBlock * static_cast<int>(block / columns);
  return {x0, y0, x0 + kBlock < tile.x1 ? x0 + kBlock : tile.x1,
          y0 + kBlock < tile.y1 ? y0 + kBlock : tile.y1};
}

/// Of the first g groups of a tile, those in which a block with share s of 1 has a part: floor(g s + 1 -
/// s/2). Whole groups, because the samples of a group are stratified together; the first one always, and all
/// if s is 1. `share` in [1, kWholeShare].
inline int64_t groups_of_block(int64_t groups, int share) {
  const int64_t rest = groups % kWholeShare;
  return (groups / kWholeShare) * share + (2 * rest * share + 2 * kWholeShare - share) / (2 * kWholeShare);
}

/// Of the first `passes` passes of a tile, in groups of `group`, those in which a block has a part.
inline int64_t passes_of_block(int64_t passes, int share, int64_t group) {
  const int64_t whole = passes / group, before = groups_of_block(whole, share);
  const bool in_rest = groups_of_block(whole + 1, share) > before;
  return before * group + (in_rest ? passes % group : 0);
}

/// Mean over the pixels of the share of the tile's passes, in (0,1]; 1 without shares.
double mean_share(const PixelRect& tile, const std::vector<uint8_t>& shares);

/// Sum over the pixels of the passes that they have of the tile's first `passes`.
double block_passes_sum(const PixelRect& tile, const std::vector<uint8_t>& shares, int64_t group,
                        int64_t passes);

/// Empty, or one for each block, none zero.
bool shares_fit(const PixelRect& tile, const std::vector<uint8_t>& shares);

}  // namespace penumbra
