#include "worker/strategies/lights_now.h"

#include "worker/lights/moving_light.h"

namespace penumbra {

const LightsNow::Moved& LightsNow::moved(size_t light, float time) {
  if (moved_.empty()) moved_.resize(lights_.area.size());
  Moved& now = moved_[light];
  if (now.time == time) return now;
  now.time = time;
  now.emitter = standing_at(lights_.area[light], double{time});
  now.strategies.clear();
  if (mix_ != nullptr)
    for (const StrategyCount& s : mix_->mix().strategies)
      now.strategies.push_back(fit(in_company(s, mix_->mix()), now.emitter));
  return now;
}

}  // namespace penumbra
