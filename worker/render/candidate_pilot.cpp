#include "worker/render/candidate_pilot.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <set>

#include "film/metrics.h"
#include "worker/render/thread_clock.h"
#include "worker/sampling/hash.h"

namespace penumbra {
namespace {

/// Pixels of a block: neighbours share what they touch in caches, as in a run, and a tile has room for many.
constexpr int kBlockWidth = 4, kBlockHeight = 2;
/// Passes in each pixel. Independent of each other, so that their scatter is the variance of a pass.
constexpr int kPasses = 4;

// Work in units of about a nanosecond, fitted to times of op-veach (490 to 580 ns a ray, 1,070 to 1,150 ns a
// line). It orders candidates where clocks may not; no time is ever reported from it. Visits of the hierarchy
// do not count: a query begins with what hid the one before it, so their number depends on what a thread did
// earlier.
constexpr double kRayWork = 530, kLineWork = 1100, kPassWork = 300;

PixelRect block_at(const PixelRect& tile, int bx, int by) {
  const int x0 = tile.x0 + bx * kBlockWidth, y0 = tile.y0 + by * kBlockHeight;
  return {x0, y0, std::min(x0 + kBlockWidth, tile.x1), std::min(y0 + kBlockHeight, tile.y1)};
}

/// Blocks of the tile such that the first n, for every n, are spread evenly: Roberts' R2 sequence (powers of
/// the plastic number's inverse), shifted by a hash of the seed and the tile.
std::vector<PixelRect> spread_blocks(const PixelRect& tile, uint64_t seed, int most) {
  const int columns = (tile.width() + kBlockWidth - 1) / kBlockWidth;
  const int rows = (tile.height() + kBlockHeight - 1) / kBlockHeight;
  const size_t wanted = size_t(std::min<int64_t>(most, int64_t{columns} * rows));
  const uint64_t key = child_key(child_key(seed, uint64_t(uint32_t(tile.x0))), uint64_t(uint32_t(tile.y0)));
  const double sx = uniform(mix64(key)), sy = uniform(mix64(key + 1));
  std::set<std::pair<int, int>> taken;
  std::vector<PixelRect> blocks;
  for (uint64_t i = 0; blocks.size() < wanted; ++i) {
    const double u = sx + double(i) * 0.7548776662466927, v = sy + double(i) * 0.5698402909980532;
    const int bx = std::min(int((u - std::floor(u)) * columns), columns - 1);
    const int by = std::min(int((v - std::floor(v)) * rows), rows - 1);
    if (taken.emplace(bx, by).second) blocks.push_back(block_at(tile, bx, by));
  }
  return blocks;
}

struct PixelSums {
  double sum[3] = {0, 0, 0}, squares[3] = {0, 0, 0};
  double mean(int c) const { return sum[c] / kPasses; }
  double variance(int c) const {
    return std::max(0.0, (squares[c] - sum[c] * sum[c] / kPasses) / (kPasses - 1));
  }
};

class CandidateRun {
 public:
  CandidateRun(const Rendering& rendering, const ChosenMix& chosen)
      : sampler_(rendering, chosen.chosen, size_t(chosen.mix), 1) {}

  void block(const PixelRect& block) {
    const double start = thread_cpu_seconds();
    size_t pixel = 0;
    for (int y = block.y0; y < block.y1; ++y)
      for (int x = block.x0; x < block.x1; ++x, ++pixel) {
        PixelSums sums;
        const uint64_t lobed = sampler_.narrow_vertices();
        for (int pass = 0; pass < kPasses; ++pass) add(sums, sampler_.sample(x, y, pass));
        cost.lobed_pixels += sampler_.narrow_vertices() != lobed;
        sums_[pixel] = sums;
      }
    cost.pixels += block.area();
    cost.cpu_seconds += thread_cpu_seconds() - start;
  }
  /// Caches of this part of the scene are cold for whoever comes first: this is nobody's time.
  void warm_up(const PixelRect& block) {
    const QueryCounters before = sampler_.counters();
    for (int y = block.y0; y < block.y1; ++y)
      for (int x = block.x0; x < block.x1; ++x) sampler_.sample(x, y, kPasses);
    sampler_.counters() = before;
  }

  MixCost finish() {
    const QueryCounters& n = sampler_.counters();
    cost.passes = kPasses;
    cost.rays = n.rays;
    cost.line_queries = n.line_queries;
    cost.work = kRayWork * double(n.rays) + kLineWork * double(n.line_queries) +
                kPassWork * double(cost.pixels * kPasses);
    return cost;
  }

  const PixelSums& at(size_t pixel) const { return sums_[pixel]; }
  MixCost cost;
  /// By how much its means stay behind the common ones, summed over pixels and channels, each relative.
  double missing = 0;

 private:
  void add(PixelSums& sums, const Rgb& value) {
    if (!is_finite(value)) {
      ++cost.non_finite;
      return;
    }
    for (int c = 0; c < 3; ++c) {
      sums.sum[c] += double(value[c]);
      sums.squares[c] += double(value[c]) * double(value[c]);
    }
  }

  PixelSampler sampler_;
  std::array<PixelSums, size_t(kBlockWidth) * kBlockHeight> sums_;
};

/// Whether some light is not infinitely far away: a point of it can be the apex of lines through media.
bool is_at_hand(const LightSet& lights) {
  return !lights.area.empty() ||
         std::any_of(lights.delta.begin(), lights.delta.end(),
                     [](const DeltaEmitter& e) { return !std::holds_alternative<DistantEmitter>(e); });
}

/// Whether the candidate is what it says for at least one light; one with lines that no light serves would be
/// the twin of one with points.
bool fits(const Mix& mix, const Scene& scene) {
  if (mix.medium == MediumSampling::kLine && !(scene.effects.media && is_at_hand(scene.lights))) return false;
  const std::vector<AreaEmitter>& area = scene.lights.area;
  const std::vector<Environment>& skies = scene.lights.environments;
  return std::all_of(mix.strategies.begin(), mix.strategies.end(), [&](const StrategyCount& wanted) {
    return !is_line(wanted.kind) || std::any_of(area.begin(), area.end(), [&](const AreaEmitter& e) {
      return is_line(fit(wanted, e));
    }) || std::any_of(skies.begin(), skies.end(), [&](const Environment& e) {
      return is_line(fit_environment(wanted, e, false));
    });
  });
}

using Runs = std::vector<std::unique_ptr<CandidateRun>>;

/// All candidates estimate the same pixel. The median of their means weighs the variances of all: a
/// candidate that has just met, or just missed, its rare bright sample must not judge itself by that.
double common_mean(const Runs& runs, size_t pixel, int channel, std::vector<double>& scratch) {
  scratch.clear();
  for (const auto& run : runs) scratch.push_back(run->at(pixel).mean(channel));
  const auto middle = scratch.begin() + ptrdiff_t(scratch.size() / 2);
  std::nth_element(scratch.begin(), middle, scratch.end());
  return *middle;
}

void add_variances(Runs& runs, size_t pixels, std::vector<double>& scratch) {
  for (size_t p = 0; p < pixels; ++p) {
    std::array<double, 3> means, weights;
    for (int c = 0; c < 3; ++c) {
      const double mean = means[size_t(c)] = common_mean(runs, p, c, scratch);
      weights[size_t(c)] = 1 / (mean * mean + kRelMseEpsilon);
    }
    for (auto& run : runs) {
      double part = 0;
      for (int c = 0; c < 3; ++c) {
        part += run->at(p).variance(c) * weights[size_t(c)];
        run->missing += (means[size_t(c)] - run->at(p).mean(c)) * std::sqrt(weights[size_t(c)]);
      }
      run->cost.relative_variance += part;
      run->cost.relative_variance_squares += part * part;
    }
  }
}

/// All candidates estimate the same, so one whose mean in the tile stays far behind has missed rare bright
/// samples, of which its own scatter knows nothing: `bsdf` alone before a small light finds a black picture
/// without any noise. What was missed on n pixels, m / 3n a channel, came with a chance below 1 / (n
/// kPasses): it adds at least (m / 3n)² n kPasses to the variance of a pass in each of 3n values. Far behind
/// is five standard deviations of the candidate's mean and of the common one, channels alike.
void charge_what_was_missed(Runs& runs) {
  constexpr double kSure = 25;
  std::vector<double> all;
  for (const auto& run : runs) all.push_back(run->cost.relative_variance);
  const auto middle = all.begin() + ptrdiff_t(all.size() / 2);
  std::nth_element(all.begin(), middle, all.end());
  for (auto& run : runs) {
    double& variance = run->cost.relative_variance;
    const double missed = run->missing > 0 ? run->missing * run->missing * kPasses / 3 : 0;
    if (!(missed > kSure * (variance + *middle))) continue;
    // How evenly it is spread is not known: its worth in pixels stays.
    double& squares = run->cost.relative_variance_squares;
    const double more = variance + missed;
    squares = variance > 0 ? squares * (more / variance) * (more / variance)
                           : more * more / double(std::max<int64_t>(run->cost.pixels, 1));
    variance = more;
  }
}

}  // namespace

std::vector<MixCost> measure_candidates(const Rendering& rendering, const TileTask& task,
                                        const std::vector<ChosenMix>& chosen,
                                        const std::atomic<bool>& cancel) {
  const double start = thread_cpu_seconds();
  Runs runs;
  std::vector<size_t> order, place;
  for (size_t k = 0; k < chosen.size(); ++k) {
    if (!fits(chosen[k].chosen, rendering.scene)) continue;
    order.push_back(runs.size());
    place.push_back(k);
    runs.push_back(std::make_unique<CandidateRun>(rendering, chosen[k]));
  }
  std::vector<MixCost> costs(chosen.size());
  if (runs.empty()) return costs;
  std::vector<double> scratch;
  uint64_t random = task.shuffle;
  for (const PixelRect& block : spread_blocks(task.tile, rendering.job.seed, task.pilot_blocks)) {
    if (cancel.load(std::memory_order_relaxed)) return {};
    for (size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[mix64(++random) % i]);
    runs[order[0]]->warm_up(block);
    for (const size_t k : order) runs[k]->block(block);
    add_variances(runs, size_t(block.area()), scratch);
    if (task.pilot_seconds > 0 && thread_cpu_seconds() - start >= task.pilot_seconds) break;
  }
  charge_what_was_missed(runs);
  double measured = 0;
  for (size_t i = 0; i < runs.size(); ++i) {
    costs[place[i]] = runs[i]->finish();
    measured += costs[place[i]].cpu_seconds;
  }
  costs[place[0]].overhead_seconds = thread_cpu_seconds() - start - measured;
  return costs;
}

}  // namespace penumbra
