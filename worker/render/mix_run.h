#pragma once
// The passes of one mix over one tile.
#include <cstdint>
#include <vector>

#include "worker/render/pixel_sampler.h"
#include "worker/render/tile_accumulator.h"

namespace penumbra {

/// What is rendered at a mix's place in a tile.
struct Rendered {
  const Mix& mix;
  int64_t group;                       ///< passes per independently scrambled group
  const std::vector<uint8_t>& shares;  ///< of the tile's blocks (proto/blocks.h); empty: all alike
};

/// The shares of blocks that are all alike.
inline const std::vector<uint8_t> kAllAlike;

/// What the task puts there: the job's mix, or what stands for an automatic one.
Rendered rendered(const JobSpec& job, const TileTask& task, size_t index);

class MixRun {
 public:
  /// The passes of mix number `index` in the task, which it refers to as long as it lives.
  MixRun(const Rendering& rendering, const TileTask& task, size_t index)
      : MixRun(rendering, task, index, rendered(rendering.job, task, index)) {}
  MixRun(const Rendering& rendering, const TileTask& task, size_t index, const Rendered& what);

  int64_t left() const { return end_ - next_; }
  void stop() { end_ = next_; }
  int64_t next() const { return next_; }
  int64_t passes() const { return cost_.passes; }
  double cpu_seconds() const { return cost_.cpu_seconds; }
  Calibration& calibration() { return cost_.calibration; }

  void pass();
  /// A pass with the blocks that pass number `other` of the tile has, as a run would make it there.
  void pass_like(int64_t other);
  /// Forgets a pilot's first pass: it paid for cold caches and first touches of memory.
  void forget();

  TilePixels pixels();
  MixCost cost();
  /// Of a run in which every block has had a part in every pass.
  std::vector<BlockCost> blocks();

 private:
  static constexpr int64_t kSitsOut = -1;

  void share_out();
  void render();
  void sample(int x, int y, size_t pixel, int64_t pass);
  void sort_into_bins(size_t pixel);

  const TileTask& task_;
  PixelSampler sampler_;
  MixCost cost_;
  TileAccumulator accumulator_;
  int64_t group_;
  const std::vector<uint8_t>& shares_;
  std::vector<int64_t> own_pass_;  ///< per block, where shares differ: its number of the tile's next pass
  int64_t next_, end_;
};

}  // namespace penumbra
