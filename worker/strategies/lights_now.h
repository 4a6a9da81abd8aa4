#pragma once
// The area lights as they stand at the time of a shading point, with what a mix's strategies are on them
// there.
#include <vector>

#include "worker/strategies/light_set.h"
#include "worker/strategies/prepared_mix.h"

namespace penumbra {

/// Belongs to one thread. Lights that stand are those of the set; of those that move the last time's are
/// kept.
class LightsNow {
 public:
  /// `mix`: null where nobody asks for strategies.
  LightsNow(const LightSet& lights, const PreparedMix* mix) : lights_(lights), mix_(mix) {}

  /// Valid until the light is asked for at another time.
  const AreaEmitter& at(size_t light, float time) {
    const AreaEmitter& emitter = lights_.area[light];
    return emitter.motion ? moved(light, time).emitter : emitter;
  }
  /// A strategy per slot of the mix; null: those that the mix has for the light at all times.
  const std::vector<Strategy>* strategies(size_t light, float time) {
    return light < lights_.area.size() && lights_.area[light].motion ? &moved(light, time).strategies
                                                                     : nullptr;
  }

 private:
  struct Moved {
    AreaEmitter emitter;
    std::vector<Strategy> strategies;
    float time = -1;
  };
  const Moved& moved(size_t light, float time);

  const LightSet& lights_;
  const PreparedMix* mix_;
  std::vector<Moved> moved_;  ///< per light, if any moves
};

}  // namespace penumbra
