// `line-uniform@DEG`: the lines of `line-area@DEG`, but with every offset across the light as likely as any
// other: p_A = 1 / (width × visible length). On a rectangle along an edge the two are one; elsewhere short
// chords get more lines than their share of the area.
#include "worker/strategies/strategy.h"

namespace penumbra {

LightLine choose(const LineUniformStrategy& strategy, const LightView&, double u) {
  return strategy.chords.choose_uniform(u);
}

LightLine through(const LineUniformStrategy& strategy, const LightView&, const Vec3d& p) {
  return strategy.chords.through_uniform(p);
}

}  // namespace penumbra
