#pragma once
// The pixels of one mix of one tile task while its passes are made.
#include <cstdint>
#include <vector>

#include "film/moments.h"
#include "film/tile_pixels.h"
#include "scenes/math.h"
#include "worker/render/bin_accumulator.h"

namespace penumbra {

class TileAccumulator {
 public:
  /// `bins`: of path lengths beside the picture (JobSpec::transient).
  TileAccumulator(const PixelRect& rect, int64_t group, int bins = 0);

  /// A pixel's value in the current pass, and what it cost in clock ticks. Blocks of pixels may sit out whole
  /// groups of passes (proto/blocks.h).
  void add(size_t pixel, const Rgb& value, uint64_t ticks) {
    Pixel& p = pixels_[pixel];
    for (int c = 0; c < 3; ++c) p.sum[c] += value[c];
    p.ticks = ticks;
    ++p.in_group;
  }
  /// What of it arrived in one bin; any number of times a pass, before add().
  void add_to_bin(size_t pixel, int bin, const Vec3d& value) { bins_.add(pixel, bin, value); }
  int bins() const { return bins_.count(); }
  /// Closes a pass: spreads its CPU seconds over the pixels by their ticks, ends the group if it is full.
  void end_pass(int64_t pass, double cpu_seconds);
  /// Closes a group that the range's end cut short.
  void finish();

  TilePixels pixels() const;
  /// Sum over pixels and channels of s²/(mean² + 1e-2), s² the variance of a pass; 0 below two groups.
  double relative_variance() const;
  /// What a pass leaves and costs in each block of pixels; every pixel has been in every pass. From few
  /// passes, so a pixel's deviation is put in relation to the mean of the pixels around it: its own mean
  /// would be zero but for the sample that makes the deviation, and say the less of it the rarer such samples
  /// are.
  std::vector<BlockCost> blocks() const;

 private:
  struct Pixel {
    double sum[3] = {0, 0, 0};  ///< of the open group
    Moments moments[3];
    int64_t in_group = 0;  ///< passes in the open group
    uint64_t ticks = 0;    ///< of the open pass
    double cost = 0;       ///< CPU µs
    /// Sum over channels, with the squares of these means in the denominator.
    double relative_variance(const Rgb& means) const;
  };
  void end_group();
  const Pixel& pixel_at(int x, int y) const {
    return pixels_[size_t(y - rect_.y0) * size_t(rect_.width()) + size_t(x - rect_.x0)];
  }
  Rgb mean_around(int x, int y) const;
  /// Counts of each block, if they are not all alike.
  void add_block_counts(TilePixels& out) const;

  PixelRect rect_;
  int64_t group_, passes_ = 0;
  std::vector<Pixel> pixels_;
  BinAccumulator bins_;
};

}  // namespace penumbra
