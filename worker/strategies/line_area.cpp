// `line-area@DEG`: chords at a fixed direction in the light's plane, offset in proportion to their length
// (Billen & Dutré 2016; Salesin & Jarosz 2019, §3).
#include "worker/strategies/strategy.h"

namespace penumbra {

LightLine choose(const LineAreaStrategy& strategy, const LightView& view, double u) {
  return choose_line_area(view.area().shape, strategy.radians, u);
}

LightLine through(const LineAreaStrategy& strategy, const LightView& view, const Vec3d& p) {
  return line_area_through(view.area().shape, strategy.radians, p);
}

}  // namespace penumbra
