#pragma once
// The pixels of one mix of one tile task while its passes are made.
#include <cstdint>
#include <vector>

#include "film/moments.h"
#include "film/tile_pixels.h"
#include "scenes/math.h"

namespace penumbra {

class TileAccumulator {
 public:
  TileAccumulator(const PixelRect& rect, int64_t group);

  /// A pixel's value in the current pass, and what it cost in clock ticks.
  void add(size_t pixel, const Rgb& value, uint64_t ticks) {
    Pixel& p = pixels_[pixel];
    for (int c = 0; c < 3; ++c) p.sum[c] += value[c];
    p.ticks = ticks;
  }
  /// Closes a pass: spreads its CPU seconds over the pixels by their ticks, ends the group if it is full.
  void end_pass(int64_t pass, double cpu_seconds);
  /// Closes a group that the range's end cut short.
  void finish();

  TilePixels pixels() const;
  /// Sum over pixels and channels of s²/(mean² + 1e-2), s² the variance of a pass; 0 below two groups.
  double relative_variance() const;

 private:
  struct Pixel {
    double sum[3] = {0, 0, 0};  ///< of the open group
    Moments moments[3];
    uint64_t ticks = 0;         ///< of the last pass
    double cost = 0;            ///< CPU µs
  };
  void end_group();

  PixelRect rect_;
  int64_t group_, in_group_ = 0, passes_ = 0;
  std::vector<Pixel> pixels_;
};

}  // namespace penumbra
