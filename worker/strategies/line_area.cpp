// `line-area@DEG`: chords at a fixed direction in the light's plane, offset in proportion to their length
// (Billen & Dutré 2016; Salesin & Jarosz 2019, §3).
#include "worker/strategies/strategy.h"

namespace penumbra {

LightLine choose(const LineAreaStrategy& strategy, const LightView&, double u) {
  return strategy.chords.choose(u);
}

LightLine through(const LineAreaStrategy& strategy, const LightView&, const Vec3d& p) {
  return strategy.chords.through(p);
}

}  // namespace penumbra
