#include "worker/render/tile_accumulator.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "film/metrics.h"
#include "proto/blocks.h"
#include "proto/status.h"

namespace penumbra {

TileAccumulator::TileAccumulator(const PixelRect& rect, int64_t group, int bins)
    : rect_(rect), group_(group), pixels_(size_t(rect.area())), bins_(pixels_.size(), bins) {}

void TileAccumulator::end_pass(int64_t pass, double cpu_seconds) {
  uint64_t ticks = 0;
  for (const Pixel& p : pixels_) ticks += p.ticks;
  const double micros_per_tick = ticks > 0 ? cpu_seconds * 1e6 / double(ticks) : 0;
  for (Pixel& p : pixels_) {
    p.cost += double(p.ticks) * micros_per_tick;
    p.ticks = 0;
  }
  ++passes_;
  // Groups are counted from pass 0 of the run, so that a range's cut does not shift them.
  if ((pass + 1) % group_ == 0) end_group();
}

void TileAccumulator::finish() {
  end_group();
}

void TileAccumulator::end_group() {
  for (Pixel& p : pixels_) {
    if (p.in_group == 0) continue;
    const double weight = double(p.in_group);
    bins_.end_group(size_t(&p - pixels_.data()), weight, p.moments[0]);
    for (int c = 0; c < 3; ++c) {
      p.moments[c].add(p.sum[c] / weight, weight);
      p.sum[c] = 0;
    }
    p.in_group = 0;
  }
}

TilePixels TileAccumulator::pixels() const {
  TilePixels out;
  out.rect = rect_;
  out.passes = passes_;
  for (const Pixel& p : pixels_) out.groups = std::max(out.groups, p.moments[0].groups);
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
  add_block_counts(out);
  bins_.put(out);
  return out;
}

void TileAccumulator::add_block_counts(TilePixels& out) const {
  if (std::all_of(pixels_.begin(), pixels_.end(),
                  [&](const Pixel& p) { return p.moments[0].weight == double(passes_); }))
    return;
  for (size_t b = 0; b < block_count(rect_); ++b) {
    const Moments& first = pixel_at(block_rect(rect_, b).x0, block_rect(rect_, b).y0).moments[0];
    PENUMBRA_CHECK(first.weight <= std::numeric_limits<int32_t>::max());  // of one task's passes
    out.block_passes.push_back(int32_t(first.weight));
    out.block_groups.push_back(int32_t(first.groups));
  }
}

double TileAccumulator::Pixel::relative_variance(const Rgb& means) const {
  double total = 0;
  for (int c = 0; c < 3; ++c)
    if (moments[c].groups > 1)
      total += moments[c].m2 / double(moments[c].groups - 1) /
               (double(means[c]) * double(means[c]) + kRelMseEpsilon);
  return total;
}

Rgb TileAccumulator::mean_around(int x, int y) const {
  constexpr int kRadius = 2;
  Rgb sum(0);
  int count = 0;
  for (int j = std::max(y - kRadius, rect_.y0); j <= std::min(y + kRadius, rect_.y1 - 1); ++j)
    for (int i = std::max(x - kRadius, rect_.x0); i <= std::min(x + kRadius, rect_.x1 - 1); ++i, ++count) {
      const Moments* m = pixel_at(i, j).moments;
      sum += Rgb(float(m[0].mean), float(m[1].mean), float(m[2].mean));
    }
  return sum / float(count);
}

double TileAccumulator::relative_variance() const {
  double sum = 0;
  for (const Pixel& p : pixels_)
    sum += p.relative_variance(
        Rgb(float(p.moments[0].mean), float(p.moments[1].mean), float(p.moments[2].mean)));
  return sum;
}

std::vector<BlockCost> TileAccumulator::blocks() const {
  std::vector<BlockCost> out;
  for (size_t b = 0; b < block_count(rect_); ++b) {
    const PixelRect block = block_rect(rect_, b);
    double deviation = 0, micros = 0;
    for (int y = block.y0; y < block.y1; ++y)
      for (int x = block.x0; x < block.x1; ++x) {
        deviation += std::sqrt(pixel_at(x, y).relative_variance(mean_around(x, y)));
        micros += pixel_at(x, y).cost;
      }
    out.push_back({float(deviation), float(micros * 1e-6 / double(passes_))});
  }
  return out;
}

}  // namespace penumbra
