#include "worker/render/auto_pilot.h"

#include <algorithm>
#include <limits>

#include "proto/auto_plan.h"
#include "worker/render/candidate_pilot.h"
#include "worker/render/mix_run.h"

namespace penumbra {
namespace {

/// What whole passes of an automatic mix's pilot may take, in units of what its candidates may. Two are worth
/// much, and dark tiles pay for bright ones; more than two are not. With 15 % of a tile's time for two nearly
/// all of op-veach's tiles have them at 20 s; at 10 % it had 1.26 times the error. The kitchen, 13 passes in
/// all, had 0.81 times the error at 10 % that it had at 30 %.
constexpr double kShareOfTwo = 3, kShareOfMore = 2;
/// Where there is time for one such pass only it is made in every so many tiles.
constexpr uint64_t kCalibrationTiles = 8;

/// The candidate by which a tile's blocks are compared: the one that has done best here, if its error is
/// bounded wherever it has not looked.
size_t level_candidate(const std::vector<ChosenMix>& candidates, const std::vector<MixCost>& costs) {
  size_t best = candidates.size();
  double least = std::numeric_limits<double>::infinity();
  for (size_t k = 0; k < candidates.size(); ++k) {
    if (costs[k].pixels < 1 || !is_bounded(candidates[k].chosen)) continue;
    const double product = costs[k].relative_variance * costs[k].cpu_seconds;
    if (best == candidates.size() || (product > 0 && product < least)) best = k;
    if (product > 0) least = std::min(least, product);
  }
  return best;
}

/// Whole passes of an automatic mix's tile by one of its candidates: what they cost, and what varies in each
/// block. Where there is no time for two of them they tell no more than their cost, which is asked of some
/// tiles only.
MixCost whole_passes(const Rendering& rendering, const TileTask& task,
                     const std::vector<ChosenMix>& candidates, const std::vector<MixCost>& costs,
                     const std::atomic<bool>& cancel) {
  const size_t k = level_candidate(candidates, costs);
  const auto index = size_t(candidates[0].mix);
  if (k == candidates.size() || task.passes[index].count() == 0) return {};
  const double foretold =
      costs[k].cpu_seconds / double(costs[k].pixels * costs[k].passes) * double(task.tile.area());
  const auto affords = [&](double seconds, double share) {
    return task.pilot_seconds <= 0 || seconds <= share * task.pilot_seconds;
  };
  const bool two = affords(2 * foretold, kShareOfTwo);
  if (!two && task.id % kCalibrationTiles != 0) return {};
  MixRun run(rendering, task, index, {candidates[k].chosen, 1, kAllAlike});
  do {
    if (cancel.load(std::memory_order_relaxed)) return {};
    run.pass();
  } while (run.left() > 0 &&
           (run.passes() < 2 ? two
                             : affords(run.cpu_seconds() * double(run.passes() + 1) / double(run.passes()),
                                       kShareOfMore)));
  MixCost cost = run.cost();
  cost.candidate = int(k);
  if (run.passes() > 1) cost.blocks = run.blocks();
  return cost;
}

}  // namespace

bool run_auto_pilot(const Rendering& rendering, const TileTask& task, const std::atomic<bool>& cancel,
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
    costs[size_t(candidates[0].mix)] = whole_passes(rendering, task, candidates, measured, cancel);
  }
  return !cancel.load(std::memory_order_relaxed);
}

}  // namespace penumbra
