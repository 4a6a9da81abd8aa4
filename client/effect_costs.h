#pragma once
// What the effects that a scene calls for cost on it: passes with each effect against passes without.
#include <stop_token>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "client/quiet_run.h"

namespace penumbra {

struct EffectCost {
  std::string effect;
  /// Of a pass: CPU time with everything over that without the effect; median, least and most of the rounds.
  double ratio = 1, least = 1, most = 1;
  /// Medians: CPU seconds of a pass with everything and without the effect.
  double pass_seconds = 0, pass_seconds_without = 0;
  /// Medians: seconds to parse and build the scene, likewise.
  double load_seconds = 0, load_seconds_without = 0;
};

/// One figure of each round, with everything and with one effect left out.
struct CostRound {
  double pass_seconds = 0, load_seconds = 0;
};
/// Rounds pair by pair; as many of either, at least one.
EffectCost effect_cost(const std::string& effect, const std::vector<CostRound>& with,
                       const std::vector<CostRound>& without);

/// Renders the job `rounds` times with everything and without each effect, in turns. The job's bundle has
/// been uploaded.
absl::StatusOr<std::vector<EffectCost>> measure_effects(Server& server, const JobSpec& job,
                                                        const std::vector<std::string>& effects,
                                                        int64_t rounds, std::stop_token stop,
                                                        const Server::EachStatus& each);

}  // namespace penumbra
