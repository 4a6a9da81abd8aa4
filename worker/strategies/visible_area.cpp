// `visible-area`: points uniform in the solid angle of what is visible of a flat light (design §5.3). Where
// nothing hides any of it, and where what hides it is too much to clip, these are the points of `sa`; in the
// second case each needs its shadow ray.
#include "worker/strategies/strategy.h"

namespace penumbra {
namespace {

/// The part to sample; null: the whole light.
const VisibleRegion* clipped(const LightView& view) {
  const VisibleRegion* region = view.region();
  return region != nullptr && region->whole() ? nullptr : region;
}

}  // namespace

LightSample sample(const VisibleAreaStrategy&, const LightView& view, const Vec2d& u) {
  const VisibleRegion* part = clipped(view);
  return towards(view, part != nullptr ? part->sample(u) : view.seen().sample(u));
}

double pdf(const VisibleAreaStrategy&, const LightView& view, const LightSample& s) {
  const VisibleRegion* part = clipped(view);
  return part != nullptr ? part->pdf(s.at.p) : view.seen().pdf(s.at.p, s.at.n);
}

}  // namespace penumbra
