#include "worker/strategies/prepared_mix.h"

namespace penumbra {

PreparedMix::PreparedMix(const Mix& mix, const LightSet& lights, bool beside_area_lights)
    : combination_(mix.combination), smoothing_{mix.smooth_shape, mix.smooth_width}, mix_(mix) {
  // Beside area lights, lines are theirs: on the sky they cost more than they bring (README.md).
  const bool lines = lights.area.empty() && !beside_area_lights;
  for (const StrategyCount& s : mix.strategies) counts_.push_back(s.count);
  std::vector<StrategyCount> wanted;
  for (const StrategyCount& s : mix.strategies) wanted.push_back(in_company(s, mix));
  fitted_.reserve((lights.area.size() + lights.environments.size()) * mix.strategies.size());
  for (const AreaEmitter& emitter : lights.area)
    for (const StrategyCount& s : wanted) fitted_.push_back(fit(s, emitter));
  for (const Environment& environment : lights.environments)
    for (const StrategyCount& s : mix.strategies) fitted_.push_back(fit_environment(s, environment, lines));
}

}  // namespace penumbra
