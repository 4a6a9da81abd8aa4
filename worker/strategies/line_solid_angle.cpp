// `line-sa@u|v`: chords parallel to an edge, uniform in the solid angle swept (Salesin & Jarosz 2019, §4;
// Ureña et al. 2013).
#include "worker/strategies/strategy.h"

namespace penumbra {

LightLine choose(const LineSolidAngleStrategy& strategy, const LightView& view, double u) {
  return choose_line_solid_angle(view.seen(), strategy.along_u, u);
}

LightLine through(const LineSolidAngleStrategy& strategy, const LightView& view, const Vec3d& p) {
  return line_solid_angle_through(view.seen(), strategy.along_u, p);
}

}  // namespace penumbra
