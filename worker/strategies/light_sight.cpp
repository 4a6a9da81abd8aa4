#include "worker/strategies/light_sight.h"

#include <algorithm>
#include <limits>

namespace penumbra {
namespace {

/// Fewer shadow rays than these cost less than a shaft (README: measured).
constexpr int kLeastRays = 16;
/// After n shafts in a row that held too much to list, the next 2^n points do without: near such a point are
/// more of its kind. Lines are the same bits either way.
constexpr int kLongestPause = 6;

/// The light's emission side looks away from x, or all of it lies below the horizon: by more than the
/// roundings of its corners and of a direction towards it.
bool out_of_sight(const LightPolygon& light, const ShadingPoint& point) {
  const Vec3d x(point.above), horizon(point.normal);
  bool behind = true, below = !point.transmits;
  for (const Vec3d& corner : light.corners) {
    const Vec3d a = corner - x;
    const double rounding = 16 * std::numeric_limits<float>::epsilon() * (a.length() + light.largest);
    behind &= (light.normal ^ a) > rounding;
    below &= (horizon ^ a) < -rounding;
  }
  return behind || below;
}

}  // namespace

std::optional<LightPolygon> polygon_of(const AreaEmitter& emitter) {
  const PrimitiveId id{kNone, emitter.mesh, emitter.first_primitive};
  if (const auto* q = std::get_if<QuadShape>(&emitter.shape))
    return LightPolygon::quad(q->o, q->u, q->v, id, emitter.primitives);
  if (const auto* t = std::get_if<TriangleShape>(&emitter.shape))
    return LightPolygon::triangle(t->p0, t->p1, t->p2, id, emitter.primitives);
  return std::nullopt;
}

bool LightSight::look(const Geometry& geometry, const ShadingPoint& point, const AreaEmitter& emitter,
                      size_t index, const VisibilityWork& work, QueryCounters& counters) {
  entered_ = false;
  if (lights_.size() <= index) lights_.resize(index + 1);
  Light& light = lights_[index];
  if (!light.known) light.polygon = polygon_of(emitter), light.known = true;
  if (!light.polygon) return true;
  if (out_of_sight(*light.polygon, point)) return false;
  if (!worth(light, work)) return true;
  geometry.enter({point.above, &*light.polygon, point.normal}, shaft_, counters);
  entered_ = true;
  x_ = point.above;
  rays_ = work.lines == 0;
  const bool failed = shaft_.content() == ShaftContent::kMany;
  light.failures = failed ? std::min(light.failures + 1, kLongestPause) : 0;
  light.pause = failed ? 1 << light.failures : 0;
  return point.transmits || shaft_.content() != ShaftContent::kHidden;
}

/// Whether to enter a shaft. For rays a pure function of the mix: they are traced by Embree where a shaft
/// does not settle them, whose roundings are not the shaft's, and an image must not depend on what was asked
/// before.
bool LightSight::worth(Light& light, const VisibilityWork& work) {
  if (work.lines == 0) return work.rays >= kLeastRays;
  if (light.pause == 0) return true;
  --light.pause;
  return false;
}

}  // namespace penumbra
