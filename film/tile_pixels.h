#pragma once
// What a worker hands back for one mix of a tile task, and what the assembler merges.
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "absl/status/statusor.h"
#include "proto/blocks.h"

namespace penumbra {

/// Means and M2 of one mix over one tile and one range of passes. Arrays are row-major over the rect,
/// mean and m2 with three channels per pixel (R G B). With no passes they say nothing: all three are empty
/// or of full size, and are not sent.
struct TilePixels {
  PixelRect rect;
  int64_t passes = 0;  ///< weight; with block counts the range's, which no block exceeds
  int64_t groups = 0;  ///< independent groups among them, 1 <= groups <= passes
  /// Where blocks have sat out some of the passes (proto/blocks.h): each one's own counts, row by row, no
  /// groups where there are no passes. Empty: every pixel has the counts above.
  std::vector<int32_t> block_passes = {}, block_groups = {};
  std::vector<float> mean;  ///< 3 per pixel
  std::vector<float> m2;    ///< 3 per pixel: sum of weight * (group mean - mean)^2
  std::vector<float> cost;  ///< CPU µs per pixel, summed over the passes; outside bit-identity
  /// Of a job with Transient: mean and m2 of what arrived in each bin, one bin's pixels after the other's.
  int bins = 0;
  std::vector<float> bin_mean = {}, bin_m2 = {};  ///< 3 per pixel and bin
};

/// All mixes of one tile task.
struct TileResult {
  std::vector<TilePixels> mixes;
};

/// The same, lying in somebody else's memory.
struct TileView {
  TileView() = default;
  TileView(const TilePixels& p)  // implicit: whoever takes a view takes the pixels themselves
      : rect(p.rect),
        passes(p.passes),
        groups(p.groups),
        block_passes(p.block_passes),
        block_groups(p.block_groups),
        mean(p.mean),
        m2(p.m2),
        cost(p.cost),
        bins(p.bins),
        bin_mean(p.bin_mean),
        bin_m2(p.bin_m2) {}
  /// What arrived in one bin, as pixels of its own, without cost.
  TileView bin(int b) const;
  /// Passes and groups of a pixel of the rect.
  std::pair<int64_t, int64_t> counts_at(int x, int y) const {
    if (block_passes.empty()) return {passes, groups};
    const size_t block = block_of(rect, x, y);
    return {block_passes[block], block_groups[block]};
  }
  PixelRect rect;
  int64_t passes = 0, groups = 0;
  std::span<const int32_t> block_passes, block_groups;
  std::span<const float> mean, m2, cost;
  int bins = 0;
  std::span<const float> bin_mean, bin_m2;
};

/// Empty if the shapes agree and every value is finite (m2 and cost not negative), else what is wrong.
/// What the serialisation demands, for whoever builds a TileResult or accepts one.
std::string fault_of(const TileView& pixels);

/// Bytes of a result: `PNTR`, then little-endian: version u32, number of mixes u32; per mix x0 y0 x1 y1 i32,
/// passes i64, groups i64, blocks u32 (their number, or 0), bins u32; with passes > 0 the i32 arrays
/// block_passes and block_groups and the float arrays mean, m2, cost, bin_mean, bin_m2, whose lengths follow
/// from the rect and the bins. A result with a fault is a programmer's fault.
std::string serialize(const TileResult& result);

/// A result as it came: its bytes, and where in them each mix lies. Nothing is copied: a server sees
/// hundreds of megabytes of them for one picture.
class ReceivedTile {
 public:
  /// InvalidArgument for bytes that are not a result, whose shapes disagree, or with a non-finite value.
  static absl::StatusOr<ReceivedTile> parse(std::string bytes);
  const std::vector<TileView>& mixes() const { return mixes_; }

 private:
  ReceivedTile() = default;
  absl::Status read();
  std::unique_ptr<const std::string> bytes_;  // where the views point, wherever the object is moved
  std::vector<TileView> mixes_;
};

}  // namespace penumbra
