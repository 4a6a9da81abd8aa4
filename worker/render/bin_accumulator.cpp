#include "worker/render/bin_accumulator.h"

namespace penumbra {

void BinAccumulator::end_group(size_t pixel, double weight, const Moments& before) {
  for (size_t b = 0; b < size_t(bins_); ++b) {
    Cell& cell = cells_[pixel * size_t(bins_) + b];
    // Most bins of a pixel never see light: their moments stay 0 whatever the counts.
    if (cell.sum == Vec3d(0) && cell.mean == Vec3d(0)) continue;
    for (int c = 0; c < 3; ++c) {
      Moments moments{before.groups, before.weight, cell.mean[c], cell.m2[c]};
      moments.add(cell.sum[c] / weight, weight);
      cell.mean[c] = moments.mean;
      cell.m2[c] = moments.m2;
    }
    cell.sum = Vec3d(0);
  }
}

void BinAccumulator::put(TilePixels& out) const {
  out.bins = bins_;
  out.bin_mean.reserve(3 * cells_.size());
  out.bin_m2.reserve(3 * cells_.size());
  for (size_t b = 0; b < size_t(bins_); ++b)
    for (size_t p = 0; p < pixels_; ++p)
      for (int c = 0; c < 3; ++c) {
        const Cell& cell = cells_[p * size_t(bins_) + b];
        out.bin_mean.push_back(float(cell.mean[c]));
        out.bin_m2.push_back(float(cell.m2[c]));
      }
}

}  // namespace penumbra
