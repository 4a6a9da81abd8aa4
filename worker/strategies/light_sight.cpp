#include "worker/strategies/light_sight.h"

#include <algorithm>
#include <limits>

#include "worker/strategies/line_need.h"

namespace penumbra {
namespace {

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

/// All of the light lies above the horizon, by more than those roundings.
bool above_horizon(const LightPolygon& light, const ShadingPoint& point) {
  const Vec3d x(point.above), horizon(point.normal);
  bool above = true;
  for (const Vec3d& corner : light.corners) {
    const Vec3d a = corner - x;
    above &= (horizon ^ a) > 16 * std::numeric_limits<float>::epsilon() * (a.length() + light.largest);
  }
  return above;
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
  skip();
  if (emitter.motion) return true;  // shafts ask at no time, and hold all that moves
  if (lights_.size() <= index) lights_.resize(index + 1);
  Light& light = lights_[index];
  if (!light.known) light.polygon = polygon_of(emitter), light.known = true;
  if (!light.polygon) return true;
  if (out_of_sight(*light.polygon, point)) {
    region_.clear();
    region_known_ = work.region;
    return false;
  }
  if (!worth(light, work)) return true;
  geometry.enter({point.above, &*light.polygon, point.normal}, shaft_, counters);
  entered_ = true;
  x_ = point.above;
  rays_ = work.lines == 0 || work.region;
  const bool failed = shaft_.content() == ShaftContent::kMany;
  light.failures = failed ? std::min(light.failures + 1, kLongestPause) : 0;
  light.pause = failed ? 1 << light.failures : 0;
  if (work.region) region_known_ = find_region(point, emitter, *light.polygon, counters);
  if (region_known_ && region_.empty()) return false;
  return point.transmits || shaft_.content() != ShaftContent::kHidden;
}

bool LightSight::find_region(const ShadingPoint& point, const AreaEmitter& emitter,
                             const LightPolygon& polygon, QueryCounters& counters) {
  // What lies below a surface that transmits is seen from another x, through another shaft.
  if (point.transmits && !above_horizon(polygon, point)) return false;
  const ShaftContent content = shaft_.content();
  if (content == ShaftContent::kMany) return false;
  if (content == ShaftContent::kHidden) {
    region_.clear();
    return true;
  }
  region_.reset(emitter.shape, Vec3d(point.above), Vec3d(point.transmits ? Vec3f(0) : point.normal),
                emitter.rounding);
  const size_t occluders = shaft_.listed();
  for (size_t i = 0; i < occluders && !region_.empty(); ++i)
    if (!region_.subtract(shaft_.triangle(i))) return false;
  if (!region_.whole()) region_.finish();
  // It costs about what a line through the same list does, and a little by the triangle.
  if (occluders > 0) ++counters.line_queries;
  return true;
}

/// Whether to enter a shaft. For rays and regions a pure function of the mix: they are traced by Embree where
/// a shaft does not settle them, whose roundings are not the shaft's, and an image must not depend on what
/// was asked before.
bool LightSight::worth(Light& light, const VisibilityWork& work) {
  if (work.region) return true;
  if (work.lines == 0) return work.rays >= kLeastShaftRays;
  if (light.pause == 0) return true;
  --light.pause;
  return false;
}

}  // namespace penumbra
