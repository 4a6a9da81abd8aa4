// Directions towards the environment by its luminance.
#include "worker/strategies/strategy.h"

namespace penumbra {

LightSample sample(const EnvironmentStrategy&, const LightView& view, const Vec2d& u) {
  const EnvironmentSample e = view.environment().sample(u);
  LightSample s;
  s.wi = e.wi;
  s.radiance = e.radiance;
  s.at = {view.far_along(e.wi), Vec3d(0), e.pdf};
  return s;
}

double pdf(const EnvironmentStrategy&, const LightView& view, const LightSample& s) {
  return view.environment().pdf(s.wi);
}

}  // namespace penumbra
