// One tile task: all its mixes on this thread, in slices of passes, interleaved at random, so that the
// machine's drift meets every mix alike (design §7).
#include <x86intrin.h>

#include <algorithm>
#include <cmath>

#include "proto/status.h"
#include "worker/render/calibration.h"
#include "worker/render/integrand.h"
#include "worker/render/light_pixels.h"
#include "worker/render/path.h"
#include "worker/render/thread_clock.h"
#include "worker/render/tile_accumulator.h"

namespace penumbra {
namespace {

/// Passes of one mix between two looks at another: short enough to interleave, long enough to warm up.
constexpr int64_t kSlice = 4;

/// Camera rays of a pass for the emission of a pixel that may see a light. Its variance falls with their number,
/// and such a pixel has little else to pay for: at sixteen the outline of cornell-box's light no longer leads
/// the image's error, and costs below 2 % of a pass.
constexpr int kEmissionRays = 16;

bool is_finite(const Rgb& c) { return std::isfinite(c.x) && std::isfinite(c.y) && std::isfinite(c.z); }

/// Probes look at pixel centres.
const Filter kCentre = Filter::centre();

/// The passes of one mix over one tile.
class MixRun {
 public:
  MixRun(const Scene& scene, const JobSpec& job, const TileTask& task, const Camera& camera,
         const std::vector<uint8_t>& light_pixels, size_t mix)
      : scene_(scene),
        job_(job),
        task_(task),
        camera_(camera),
        filter_(job.probe ? kCentre : *scene.filter),
        light_pixels_(light_pixels),
        mix_index_(uint32_t(mix)),
        prepared_(job.mixes[mix], scene.lights),
        tracer_(scene, prepared_, job.max_depth, counters_),
        accumulator_(task.tile, task.group),
        next_(task.passes[mix].begin),
        end_(task.passes[mix].end) {}

  int64_t left() const { return end_ - next_; }
  void stop() { end_ = next_; }
  double cpu_seconds() const { return cost_.cpu_seconds; }
  Calibration& calibration() { return cost_.calibration; }

  void pass() {
    const double start = thread_cpu_seconds();
    size_t pixel = 0;
    for (int y = task_.tile.y0; y < task_.tile.y1; ++y)
      for (int x = task_.tile.x0; x < task_.tile.x1; ++x) sample(x, y, pixel++);
    const double seconds = thread_cpu_seconds() - start;
    accumulator_.end_pass(next_++, seconds);
    cost_.cpu_seconds += seconds;
    ++cost_.passes;
  }

  /// Forgets a pilot's first pass: it paid for cold caches and first touches of memory.
  void forget() {
    accumulator_ = TileAccumulator(task_.tile, task_.group);
    counters_ = {};
    cost_ = {};
  }

  TilePixels pixels() {
    accumulator_.finish();
    return accumulator_.pixels();
  }
  MixCost cost() {
    accumulator_.finish();
    cost_.rays = counters_.rays;
    cost_.line_queries = counters_.line_queries;
    cost_.relative_variance = accumulator_.relative_variance();
    return cost_;
  }

 private:
  void sample(int x, int y, size_t pixel) {
    const uint64_t start = __rdtsc();
    const uint32_t index = uint32_t(y) * uint32_t(job_.width) + uint32_t(x);
    const PassSampler sampler(job_.sampler, job_.seed, mix_index_, task_.kind, index, next_, task_.group);
    const FilterSample filter = filter_.sample(sampler.film());
    const Vec2d centre(x + 0.5, y + 0.5);
    const bool apart = light_pixels_[pixel] != 0;
    Rgb value = tracer_.radiance(ray(centre, filter), sampler, !apart) * float(filter.weight);
    if (apart) value += emission(centre, sampler);
    if (!is_finite(value)) {
      ++cost_.non_finite;
      value = Rgb(0);
    }
    accumulator_.add(pixel, value, __rdtsc() - start);
  }

  CameraRay ray(const Vec2d& centre, const FilterSample& filter) const {
    Vec2d at = centre + filter.offset;
    if (const double cells = job_.camera_grid; cells > 0)
      at = Vec2d(std::floor(at.x * cells) + 0.5, std::floor(at.y * cells) + 0.5) / cells;
    return camera_.ray(at);
  }

  /// Mean emission over the pixel's filter, from rays of its own.
  Rgb emission(const Vec2d& centre, const PassSampler& sampler) {
    Rgb sum(0);
    for (int i = 0; i < kEmissionRays; ++i) {
      const FilterSample filter = filter_.sample(sampler.film(i, kEmissionRays));
      sum += tracer_.emission(ray(centre, filter)) * float(filter.weight);
    }
    return sum / float(kEmissionRays);
  }

  const Scene& scene_;
  const JobSpec& job_;
  const TileTask& task_;
  const Camera& camera_;
  const Filter& filter_;
  const std::vector<uint8_t>& light_pixels_;  ///< of the tile
  uint32_t mix_index_;
  PreparedMix prepared_;
  QueryCounters counters_;
  MixCost cost_;
  PathTracer tracer_;
  TileAccumulator accumulator_;
  int64_t next_, end_;
};

/// A small generator for the interleaving, which is no part of the image (SplitMix64, Steele et al. 2014).
uint64_t next_random(uint64_t& state) {
  uint64_t z = state += 0x9e3779b97f4a7c15;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9;
  z = (z ^ (z >> 27)) * 0x94d049bb133111eb;
  return z ^ (z >> 31);
}

/// Every mix as often as it has slices, shuffled.
std::vector<size_t> interleaving(const TileTask& task) {
  std::vector<size_t> slices;
  for (size_t m = 0; m < task.passes.size(); ++m)
    slices.insert(slices.end(), size_t((task.passes[m].count() + kSlice - 1) / kSlice), m);
  uint64_t state = task.shuffle;
  for (size_t i = slices.size(); i > 1; --i) std::swap(slices[i - 1], slices[next_random(state) % i]);
  return slices;
}

/// A pilot measures until its time is up, at least one pass; the first is thrown away if there is time.
bool run_pilot(std::vector<std::unique_ptr<MixRun>>& runs, double seconds, const std::atomic<bool>& cancel) {
  for (auto& run : runs) {
    for (int done = 0; run->left() > 0; ++done) {
      if (cancel.load(std::memory_order_relaxed)) return false;
      run->pass();
      const double spent = run->cpu_seconds();
      if (done == 0 && run->left() > 0 && (seconds <= 0 || 2 * spent < seconds)) {
        run->forget();
        continue;
      }
      if (seconds > 0 && spent >= seconds) run->stop();
    }
  }
  return true;
}

}  // namespace

TaskOutcome render_tile(const Scene& scene, const JobSpec& job, const TileTask& task,
                        const std::atomic<bool>& cancel) {
  PENUMBRA_CHECK(task.passes.size() == job.mixes.size());
  if (job.probe && job.probe->kind == Probe::Kind::kIntegrand) return render_integrand(scene, job, task, cancel);
  TaskOutcome outcome;
  const auto camera = Camera::build(scene.description, job.width, job.height);
  PENUMBRA_CHECK(camera.ok());  // build_scene() has tried it
  const std::vector<uint8_t> seeing = light_pixels(scene, *camera, task.tile);
  std::vector<std::unique_ptr<MixRun>> runs;
  for (size_t m = 0; m < job.mixes.size(); ++m)
    runs.push_back(std::make_unique<MixRun>(scene, job, task, *camera, seeing, m));

  if (task.kind == TaskKind::kPilot) {
    outcome.cancelled = !run_pilot(runs, task.pilot_seconds, cancel);
  } else {
    CalibrationClock calibration;
    for (size_t m : interleaving(task)) {
      calibration.before_slice(runs[m]->calibration());
      for (int64_t p = std::min(kSlice, runs[m]->left()); p > 0; --p) {
        if (cancel.load(std::memory_order_relaxed)) {
          outcome.cancelled = true;
          return outcome;
        }
        runs[m]->pass();
      }
    }
    for (auto& run : runs) outcome.pixels.mixes.push_back(run->pixels());
  }
  for (auto& run : runs) outcome.costs.push_back(run->cost());
  return outcome;
}

}  // namespace penumbra
