#pragma once
// What arrives at the pixels of a tile in bins of path length, while its passes are made.
#include <vector>

#include "film/moments.h"
#include "film/tile_pixels.h"
#include "scenes/math.h"

namespace penumbra {

/// Moments of every bin of every pixel; the counts of groups and passes are the pixels'. 72 bytes a bin and
/// pixel.
class BinAccumulator {
 public:
  BinAccumulator(size_t pixels, int bins) : pixels_(pixels), bins_(bins), cells_(pixels * size_t(bins)) {}

  int count() const { return bins_; }
  void add(size_t pixel, int bin, const Vec3d& value) {
    cells_[pixel * size_t(bins_) + size_t(bin)].sum += value;
  }
  /// Closes the pixel's open group of `weight` passes; `before`: the counts of its closed ones.
  void end_group(size_t pixel, double weight, const Moments& before);
  /// Means and M2, bin by bin.
  void put(TilePixels& out) const;

 private:
  struct Cell {
    Vec3d sum{0}, mean{0}, m2{0};
  };
  size_t pixels_;
  int bins_;
  std::vector<Cell> cells_;  ///< a pixel's bins together: what a sample touches lies close
};

}  // namespace penumbra
