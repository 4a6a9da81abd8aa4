// `sa`: points uniform in the solid angle of the light's shape (Ureña et al. 2013 for rectangles).
#include "worker/strategies/strategy.h"

namespace penumbra {

LightSample sample(const SolidAngleStrategy&, const LightView& view, const Vec2d& u) {
  return towards(view, view.seen().sample(u));
}

double pdf(const SolidAngleStrategy&, const LightView& view, const LightSample& s) {
  return view.seen().pdf(s.at.p, s.at.n);
}

}  // namespace penumbra
