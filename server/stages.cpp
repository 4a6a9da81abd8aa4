#include "server/stages.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "proto/status.h"

namespace penumbra {
namespace {

std::vector<Stage> stages(const PlannedPasses& planned, std::vector<Stage> earlier, int64_t total) {
  for (const double border : planned.open) earlier.push_back({border, total});
  earlier.push_back({1, total});
  return earlier;
}

}  // namespace

std::vector<double> borders_of(const JobSpec& spec) {
  if (!spec.plan.empty() || !std::holds_alternative<CpuSecondsBudget>(spec.budget)) return {};
  return {std::begin(kStageBorders), std::end(kStageBorders)};
}

double measured_share(const std::vector<EarlierPlan>& earlier) {
  return earlier.empty() ? kFirstMeasured : earlier.back().until;
}

std::vector<Stage> stages_of(const PlannedPasses& planned, size_t mix) {
  std::vector<Stage> earlier;
  for (const EarlierPlan& plan : planned.earlier) earlier.push_back({plan.until, plan.passes[mix]});
  return stages(planned, std::move(earlier), planned.passes[mix]);
}

std::vector<Stage> stages_of(const PlannedPasses& planned, size_t automatic, size_t tile) {
  std::vector<Stage> earlier;
  for (const EarlierPlan& plan : planned.earlier)
    earlier.push_back({plan.until, plan.autos[automatic][tile]});
  return stages(planned, std::move(earlier), planned.autos[automatic].tiles[tile].passes);
}

int64_t passes_at(double share, const std::vector<Stage>& stages, int64_t group) {
  double from = 0;
  int64_t done = 0;
  for (const Stage& stage : stages) {
    if (share == 1 && stage.until == 1) return stage.total;
    const auto groups_at = [&](double at) {
      return (at - from) / (1 - from) * static_cast<double>(stage.total - done) / static_cast<double>(group);
    };
    const int64_t border = stage.until == 1
                               ? stage.total
                               : done + static_cast<int64_t>(std::floor(groups_at(stage.until))) * group;
    if (share < stage.until)
      return std::min(done + static_cast<int64_t>(std::llround(groups_at(share))) * group, border);
    done = border;
    from = stage.until;
    if (share == stage.until) break;
  }
  return done;
}

}  // namespace penumbra
