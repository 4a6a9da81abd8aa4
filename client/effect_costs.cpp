#include "client/effect_costs.h"

#include <algorithm>
#include <map>

#include "proto/status.h"

namespace penumbra {
namespace {

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : (values[half - 1] + values[half]) / 2;
}

template <class Figure>
double median_of(const std::vector<CostRound>& rounds, Figure figure) {
  std::vector<double> values;
  for (const CostRound& round : rounds) values.push_back(round.*figure);
  return median(std::move(values));
}

absl::StatusOr<CostRound> one_round(Server& server, const JobSpec& job, std::stop_token stop,
                                    const Server::EachStatus& each) {
  ASSIGN_OR_RETURN(const FetchedRun run, run_quietly(server, job, stop, each));
  const MixSummary& mix = run.summary.mixes.front();
  return CostRound{mix.cpu_seconds / static_cast<double>(std::max<int64_t>(mix.passes, 1)),
                   run.summary.load.parse_seconds + run.summary.load.build_seconds};
}

}  // namespace

EffectCost effect_cost(const std::string& effect, const std::vector<CostRound>& with,
                       const std::vector<CostRound>& without) {
  PENUMBRA_CHECK(!with.empty() && with.size() == without.size());
  std::vector<double> ratios;
  for (size_t r = 0; r < with.size(); ++r) ratios.push_back(with[r].pass_seconds / without[r].pass_seconds);
  EffectCost cost{effect};
  cost.ratio = median(ratios);
  cost.least = *std::min_element(ratios.begin(), ratios.end());
  cost.most = *std::max_element(ratios.begin(), ratios.end());
  cost.pass_seconds = median_of(with, &CostRound::pass_seconds);
  cost.pass_seconds_without = median_of(without, &CostRound::pass_seconds);
  cost.load_seconds = median_of(with, &CostRound::load_seconds);
  cost.load_seconds_without = median_of(without, &CostRound::load_seconds);
  return cost;
}

absl::StatusOr<std::vector<EffectCost>> measure_effects(Server& server, const JobSpec& job,
                                                        const std::vector<std::string>& effects,
                                                        int64_t rounds, std::stop_token stop,
                                                        const Server::EachStatus& each) {
  std::vector<CostRound> with;
  std::map<std::string, std::vector<CostRound>> without;
  for (int64_t r = 0; r < rounds; ++r) {
    JobSpec spec = job;
    spec.seed += static_cast<uint64_t>(r);
    ASSIGN_OR_RETURN(const CostRound all, one_round(server, spec, stop, each));
    with.push_back(all);
    for (const std::string& effect : effects) {
      spec.leave_out = {effect};
      ASSIGN_OR_RETURN(const CostRound fewer, one_round(server, spec, stop, each));
      without[effect].push_back(fewer);
    }
  }
  std::vector<EffectCost> costs;
  for (const std::string& effect : effects) costs.push_back(effect_cost(effect, with, without[effect]));
  return costs;
}

}  // namespace penumbra
