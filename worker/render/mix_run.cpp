#include "worker/render/mix_run.h"

#include <x86intrin.h>

#include <cmath>

#include "proto/blocks.h"
#include "worker/render/thread_clock.h"

namespace penumbra {

Rendered rendered(const JobSpec& job, const TileTask& task, size_t index) {
  if (job.mixes[index].automatic)
    for (const ChosenMix& chosen : task.chosen)
      if (chosen.mix == int(index)) return {chosen.chosen, chosen.group, chosen.shares};
  return {job.mixes[index], task.group, kAllAlike};
}

static int bins_of(const JobSpec& job) {
  return job.transient ? job.transient->bins : 0;
}

MixRun::MixRun(const Rendering& rendering, const TileTask& task, size_t index, const Rendered& what)
    : task_(task),
      sampler_(rendering, what.mix, index, what.group),
      accumulator_(task.tile, what.group, bins_of(rendering.job)),
      group_(what.group),
      shares_(what.shares),
      next_(task.passes[index].begin),
      end_(task.passes[index].end) {}

void MixRun::pass() {
  share_out();
  render();
}

void MixRun::pass_like(int64_t other) {
  own_pass_.resize(shares_.size());
  for (size_t b = 0; b < shares_.size(); ++b) {
    const int64_t before = passes_of_block(other, shares_[b], group_);
    own_pass_[b] = passes_of_block(other + 1, shares_[b], group_) > before ? next_ : kSitsOut;
  }
  render();
}

void MixRun::render() {
  const double start = thread_cpu_seconds();
  size_t pixel = 0;
  for (int y = task_.tile.y0; y < task_.tile.y1; ++y)
    for (int x = task_.tile.x0; x < task_.tile.x1; ++x, ++pixel) {
      const int64_t own = shares_.empty() ? next_ : own_pass_[block_of(task_.tile, x, y)];
      if (own != kSitsOut) sample(x, y, pixel, own);
    }
  const double seconds = thread_cpu_seconds() - start;
  accumulator_.end_pass(next_++, seconds);
  cost_.cpu_seconds += seconds;
  ++cost_.passes;
}

void MixRun::share_out() {
  own_pass_.resize(shares_.size());
  for (size_t b = 0; b < shares_.size(); ++b) {
    const int64_t own = passes_of_block(next_, shares_[b], group_);
    own_pass_[b] = passes_of_block(next_ + 1, shares_[b], group_) > own ? own : kSitsOut;
  }
}

void MixRun::sample(int x, int y, size_t pixel, int64_t pass) {
  const uint64_t start = __rdtsc();
  Rgb value = sampler_.sample(x, y, pass);
  if (!is_finite(value)) {
    ++cost_.non_finite;
    value = Rgb(0);
  }
  if (sampler_.bins() != nullptr) sort_into_bins(pixel);
  accumulator_.add(pixel, value, __rdtsc() - start);
}

void MixRun::sort_into_bins(size_t pixel) {
  sampler_.bins()->take([&](int bin, const Vec3d& value) {
    if (std::isfinite(value.x) && std::isfinite(value.y) && std::isfinite(value.z))
      accumulator_.add_to_bin(pixel, bin, value);
    else
      ++cost_.non_finite;
  });
}

void MixRun::forget() {
  accumulator_ = TileAccumulator(task_.tile, group_, accumulator_.bins());
  sampler_.counters() = {};
  cost_ = {};
}

TilePixels MixRun::pixels() {
  accumulator_.finish();
  return accumulator_.pixels();
}

MixCost MixRun::cost() {
  accumulator_.finish();
  cost_.rays = sampler_.counters().rays;
  cost_.line_queries = sampler_.counters().line_queries;
  cost_.relative_variance = accumulator_.relative_variance();
  return cost_;
}

std::vector<BlockCost> MixRun::blocks() {
  accumulator_.finish();
  return accumulator_.blocks();
}

}  // namespace penumbra
