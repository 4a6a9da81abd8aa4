// Light through a portal: directions by what is behind it, or uniform in its solid angle, and its chords.
#include "worker/strategies/strategy.h"

namespace penumbra {

LightSample sample(const PortalStrategy&, const LightView& view, const Vec2d& u) {
  const SeenPortal::Sample drawn = view.portal().sample(u);
  LightSample s;
  if (!(drawn.pdf > 0)) return s;
  s.wi = Vec3f(drawn.w);
  s.radiance = view.environment().radiance(s.wi);
  s.at = {view.far_along(s.wi), Vec3d(0), drawn.pdf};
  return s;
}

double pdf(const PortalStrategy&, const LightView& view, const LightSample& s) {
  return view.portal().pdf(Vec3d(s.wi));
}

LightLine choose(const PortalChordStrategy& strategy, const LightView& view, double u) {
  return view.portal().choose_chord(strategy.along_u, u, view.portal_far());
}

LightLine through(const PortalChordStrategy& strategy, const LightView& view, const Vec3d& p) {
  return view.portal().chord_through(strategy.along_u, p, view.portal_far());
}

}  // namespace penumbra
