// One tile task: all its mixes on this thread, in slices of passes, interleaved at random, so that the
// machine's drift meets every mix alike (design §7).
#include <algorithm>
#include <memory>
#include <set>

#include "proto/status.h"
#include "worker/render/auto_pilot.h"
#include "worker/render/calibration.h"
#include "worker/render/integrand.h"
#include "worker/render/mix_run.h"
#include "worker/strategies/line_need.h"

namespace penumbra {
namespace {

/// Passes of one mix between two looks at another: short enough to interleave, long enough to warm up.
constexpr int64_t kSlice = 4;

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
    for (size_t n = places_[mix].count(pass); n > 0; --n) runs_[mix]->pass_like(pass);
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

/// A pilot measures until its time is up, at least one pass; the first is thrown away if there is time.
/// Automatic mixes have a pilot of their own.
bool run_pilot(std::vector<std::unique_ptr<MixRun>>& runs, const JobSpec& job, double seconds,
               const std::atomic<bool>& cancel) {
  for (size_t m = 0; m < runs.size(); ++m) {
    if (job.mixes[m].automatic) continue;
    auto& run = runs[m];
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
  // So are the tables of maps that lines on the sky are drawn from.
  const bool by_map = std::any_of(job.mixes.begin(), job.mixes.end(), [](const Mix& mix) {
    return std::any_of(mix.strategies.begin(), mix.strategies.end(),
                       [](const StrategyCount& s) { return s.kind == StrategyKind::kLineSolidAngleV; });
  });
  if (by_map && scene.lights.area.empty())
    for (const Environment& light : scene.lights.environments)
      if (light.portal() == nullptr) light.arcs();
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
    outcome.cancelled = !run_pilot(runs, job, task.pilot_seconds, cancel);
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
  if (!outcome.cancelled) outcome.cancelled = !run_auto_pilot(rendering, task, cancel, outcome.costs);
  return outcome;
}

}  // namespace penumbra
