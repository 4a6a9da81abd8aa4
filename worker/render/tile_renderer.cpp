// One tile task: all its mixes on this thread, in slices of passes, interleaved at random, so that the
// machine's drift meets every mix alike (design §7).
#include <x86intrin.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "proto/status.h"
#include "worker/render/calibration.h"
#include "worker/render/candidate_pilot.h"
#include "worker/render/integrand.h"
#include "worker/render/pixel_sampler.h"
#include "worker/render/thread_clock.h"
#include "worker/render/tile_accumulator.h"
#include "worker/strategies/line_need.h"

namespace penumbra {
namespace {

/// Passes of one mix between two looks at another: short enough to interleave, long enough to warm up.
constexpr int64_t kSlice = 4;

/// What is rendered at a mix's place in this tile.
struct Rendered {
  const Mix& mix;
  int64_t group;
};
Rendered rendered(const JobSpec& job, const TileTask& task, size_t index) {
  if (job.mixes[index].automatic)
    for (const ChosenMix& chosen : task.chosen)
      if (chosen.mix == int(index)) return {chosen.chosen, chosen.group};
  return {job.mixes[index], task.group};
}

/// The passes of one mix over one tile.
class MixRun {
 public:
  MixRun(const Rendering& rendering, const TileTask& task, size_t index)
      : MixRun(rendering, task, index, rendered(rendering.job, task, index)) {}

  int64_t left() const { return end_ - next_; }
  void stop() { end_ = next_; }
  int64_t next() const { return next_; }
  int64_t passes() const { return cost_.passes; }
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
    sampler_.counters() = {};
    cost_ = {};
  }

  TilePixels pixels() {
    accumulator_.finish();
    return accumulator_.pixels();
  }
  MixCost cost() {
    accumulator_.finish();
    cost_.rays = sampler_.counters().rays;
    cost_.line_queries = sampler_.counters().line_queries;
    cost_.relative_variance = accumulator_.relative_variance();
    return cost_;
  }

 private:
  MixRun(const Rendering& rendering, const TileTask& task, size_t index, const Rendered& what)
      : task_(task),
        sampler_(rendering, what.mix, index, what.group),
        accumulator_(task.tile, what.group),
        next_(task.passes[index].begin),
        end_(task.passes[index].end) {}

  void sample(int x, int y, size_t pixel) {
    const uint64_t start = __rdtsc();
    Rgb value = sampler_.sample(x, y, next_);
    if (!is_finite(value)) {
      ++cost_.non_finite;
      value = Rgb(0);
    }
    accumulator_.add(pixel, value, __rdtsc() - start);
  }

  const TileTask& task_;
  PixelSampler sampler_;
  MixCost cost_;
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

/// Passes of the pilot that a run task repeats between its own: timed and thrown away. Each takes its place
/// before any of the mix's own passes with the same probability, so that it finds caches as warm as these do
/// on average.
class Repilot {
 public:
  Repilot(const Rendering& rendering, const TileTask& task) : rendering_(rendering), task_(task) {
    if (task.repilot.empty()) return;
    rendering_.kind = TaskKind::kPilot;
    task_.passes = task.repilot;
    for (size_t m = 0; m < task.passes.size(); ++m) {
      runs_.push_back(std::make_unique<MixRun>(rendering_, task_, m));
      places_.emplace_back();
      uint64_t state = task.shuffle + m;
      for (int64_t p = task.passes[m].count() > 0 ? task.repilot[m].count() : 0; p > 0; --p)
        places_[m].insert(task.passes[m].begin +
                          int64_t(next_random(state) % uint64_t(task.passes[m].count())));
    }
  }

  /// Whatever has its place before this pass of this mix.
  void before(size_t mix, int64_t pass) {
    if (runs_.empty()) return;
    for (size_t n = places_[mix].count(pass); n > 0; --n) runs_[mix]->pass();
  }

  void report(std::vector<MixCost>& costs) const {
    for (size_t m = 0; m < runs_.size(); ++m) {
      costs[m].repilot_passes = runs_[m]->passes();
      costs[m].repilot_seconds = runs_[m]->cpu_seconds();
    }
  }

 private:
  Rendering rendering_;
  TileTask task_;
  std::vector<std::unique_ptr<MixRun>> runs_;
  std::vector<std::multiset<int64_t>> places_;  ///< per mix: its own passes that one of the pilot's precedes
};

/// Costs of all candidates, in the task's order; those of one automatic mix stand together. False: cancelled.
bool run_candidates(const Rendering& rendering, const TileTask& task, const std::atomic<bool>& cancel,
                    std::vector<MixCost>& costs) {
  for (size_t begin = 0; begin < task.chosen.size();) {
    std::vector<ChosenMix> candidates;
    for (; begin < task.chosen.size(); ++begin) {
      if (!candidates.empty() && candidates[0].mix != task.chosen[begin].mix) break;
      candidates.push_back(task.chosen[begin]);
    }
    const std::vector<MixCost> measured = measure_candidates(rendering, task, candidates, cancel);
    if (measured.empty()) return false;
    costs.insert(costs.end(), measured.begin(), measured.end());
  }
  return true;
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
  // Before any clock: what lines walk is part of the load, of jobs that have lines.
  for (const Mix& mix : job.mixes)
    if (needs_line_hierarchy(mix, scene.lights)) scene.geometry->prepare_lines();
  if (job.probe && job.probe->kind == Probe::Kind::kIntegrand)
    return render_integrand(scene, job, task, cancel);
  TaskOutcome outcome;
  const auto camera = Camera::build(scene.description, job.width, job.height);
  PENUMBRA_CHECK(camera.ok());  // build_scene() has tried it
  const Rendering rendering{scene,     job,       *camera,
                            task.kind, task.tile, light_pixels(scene, *camera, task.tile)};
  std::vector<std::unique_ptr<MixRun>> runs;
  for (size_t m = 0; m < job.mixes.size(); ++m) runs.push_back(std::make_unique<MixRun>(rendering, task, m));

  if (task.kind == TaskKind::kPilot) {
    outcome.cancelled = !run_pilot(runs, task.pilot_seconds, cancel);
  } else {
    CalibrationClock calibration;
    Repilot repilot(rendering, task);
    for (size_t m : interleaving(task)) {
      calibration.before_slice(runs[m]->calibration());
      for (int64_t p = std::min(kSlice, runs[m]->left()); p > 0; --p) {
        if (cancel.load(std::memory_order_relaxed)) {
          outcome.cancelled = true;
          return outcome;
        }
        repilot.before(m, runs[m]->next());
        runs[m]->pass();
      }
    }
    for (auto& run : runs) {
      outcome.pixels.mixes.push_back(run->pixels());
      outcome.costs.push_back(run->cost());
    }
    repilot.report(outcome.costs);
    return outcome;
  }
  for (auto& run : runs) outcome.costs.push_back(run->cost());
  if (!outcome.cancelled) outcome.cancelled = !run_candidates(rendering, task, cancel, outcome.costs);
  return outcome;
}

}  // namespace penumbra
