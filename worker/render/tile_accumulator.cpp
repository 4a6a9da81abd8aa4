#include "worker/render/tile_accumulator.h"

#include "film/metrics.h"

namespace penumbra {

TileAccumulator::TileAccumulator(const PixelRect& rect, int64_t group)
    : rect_(rect), group_(group), pixels_(size_t(rect.area())) {}

void TileAccumulator::end_pass(int64_t pass, double cpu_seconds) {
  uint64_t ticks = 0;
  for (const Pixel& p : pixels_) ticks += p.ticks;
  const double micros_per_tick = ticks > 0 ? cpu_seconds * 1e6 / double(ticks) : 0;
  for (Pixel& p : pixels_) p.cost += double(p.ticks) * micros_per_tick;
  ++passes_;
  ++in_group_;
  // Groups are counted from pass 0 of the run, so that a range's cut does not shift them.
  if ((pass + 1) % group_ == 0) end_group();
}

void TileAccumulator::finish() {
  if (in_group_ > 0) end_group();
}

void TileAccumulator::end_group() {
  const double weight = double(in_group_);
  for (Pixel& p : pixels_)
    for (int c = 0; c < 3; ++c) {
      p.moments[c].add(p.sum[c] / weight, weight);
      p.sum[c] = 0;
    }
  in_group_ = 0;
}

TilePixels TileAccumulator::pixels() const {
  TilePixels out;
  out.rect = rect_;
  out.passes = passes_;
  out.groups = pixels_.empty() ? 0 : pixels_[0].moments[0].groups;
  out.mean.reserve(pixels_.size() * 3);
  out.m2.reserve(pixels_.size() * 3);
  out.cost.reserve(pixels_.size());
  for (const Pixel& p : pixels_) {
    for (int c = 0; c < 3; ++c) {
      out.mean.push_back(float(p.moments[c].mean));
      out.m2.push_back(float(p.moments[c].m2));
    }
    out.cost.push_back(float(p.cost));
  }
  return out;
}

double TileAccumulator::relative_variance() const {
  double sum = 0;
  for (const Pixel& p : pixels_)
    for (const Moments& m : p.moments)
      if (m.groups > 1) sum += m.m2 / double(m.groups - 1) / (m.mean * m.mean + kRelMseEpsilon);
  return sum;
}

}  // namespace penumbra
