#include "proto/auto_plan.h"

#include <algorithm>

#include "proto/status.h"

namespace penumbra {

const std::vector<Mix>& auto_candidates() {
  static const std::vector<Mix> candidates = [] {
    std::vector<Mix> mixes;
    for (const char* text :
         {"bsdf:2+sa:2", "bsdf:1+sa:1", "bsdf:1+sa:3", "bsdf:2+sa:6", "bsdf:4", "sa:4", "bsdf:3+line-sa@v:1",
          "bsdf:2+line-sa@v:2", "bsdf:1+line-sa@v:3", "line-sa@v:4", "bsdf:2+visible-area:2",
          "visible-area:2", "bsdf:1+sa:1/medium=line", "sa:2/medium=line", "line-sa@v:2/medium=line"})
      mixes.push_back(*parse_mix(text));
    return mixes;
  }();
  return candidates;
}

size_t common_candidates() {
  const std::vector<Mix>& all = auto_candidates();
  return static_cast<size_t>(
      std::count_if(all.begin(), all.end(), [](const Mix& m) { return m.medium == MediumSampling::kPoint; }));
}

bool is_bounded(const Mix& mix) {
  return std::any_of(mix.strategies.begin(), mix.strategies.end(),
                     [](const StrategyCount& s) { return s.kind == StrategyKind::kBsdf; });
}

std::vector<int> automatic_mixes(const std::vector<Mix>& mixes) {
  std::vector<int> places;
  for (size_t m = 0; m < mixes.size(); ++m)
    if (mixes[m].automatic) places.push_back(static_cast<int>(m));
  return places;
}

absl::Status check_auto_plans(const std::vector<AutoPlan>& plans, const std::vector<Mix>& mixes) {
  if (plans.empty()) return absl::OkStatus();
  const std::vector<int> places = automatic_mixes(mixes);
  if (plans.size() != places.size())
    return invalid_input("auto_plans: {} plans for {} mixes `auto`", plans.size(), places.size());
  for (size_t i = 0; i < plans.size(); ++i)
    if (plans[i].mix != places[i])
      return invalid_input("auto_plans: a plan of mix {}, where that of mix {} belongs", plans[i].mix,
                           places[i]);
  return absl::OkStatus();
}

absl::Status check_earlier_plans(const std::vector<EarlierPlan>& plans, const std::vector<Mix>& mixes) {
  double before = 0;
  for (const EarlierPlan& plan : plans) {
    if (!(plan.until > before) || !(plan.until < 1))
      return invalid_input("earlier_plans: a border at {}, where one in ({}, 1) belongs", plan.until, before);
    before = plan.until;
    if (plan.passes.size() != mixes.size() || plan.autos.size() != automatic_mixes(mixes).size())
      return invalid_input(
          "earlier_plans: counts of {} mixes, {} of them `auto`, where the job has {} and {}",
          plan.passes.size(), plan.autos.size(), mixes.size(), automatic_mixes(mixes).size());
  }
  return absl::OkStatus();
}

}  // namespace penumbra
