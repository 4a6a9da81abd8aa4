#include "worker/render/tube_surface.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "worker/geometry/tube.h"

namespace penumbra {
namespace {

/// Bound of the rounding that a shadow ray must clear, per coordinate: of the point itself (half a unit in
/// the last place of the largest coordinate, as the offset's direction is any), and of what Embree computes
/// for a ray that starts there, a quadratic in lengths of the segment: a few units of its extent. 32 in all;
/// see TubeSurface.AShadowRayLeavesItsOwnTube.
constexpr float kRounding = 32 * std::numeric_limits<float>::epsilon() / 2;

Vec3d direction_of(const Tubes& tubes, size_t segment) {
  return TubeSegment(&tubes.points[tubes.segments[segment]]).e.normalized();
}

/// The curve's direction: at joints half way between the neighbours', so that shading does not show the
/// chords.
Vec3d tangent_at(const Tubes& tubes, size_t i, double w) {
  const std::vector<uint32_t>& first = tubes.segments;
  const Vec3d own = direction_of(tubes, i);
  Vec3d start = own, end = own;
  if (i > 0 && first[i - 1] + 1 == first[i]) start += direction_of(tubes, i - 1);
  if (i + 1 < first.size() && first[i] + 1 == first[i + 1]) end += direction_of(tubes, i + 1);
  const Vec3d blended = start.normalized() * (1 - w) + end.normalized() * w;
  return blended.dot(own) > 0 ? blended.normalized() : own;
}

/// v without its part along unit t; `fallback` where nothing is left.
Vec3d upright(const Vec3d& v, const Vec3d& t, const Vec3d& fallback) {
  const Vec3d across = v - t * v.dot(t);
  return across.length2() > 0x1p-40 * v.length2() ? across.normalized() : fallback;
}

}  // namespace

SurfacePoint tube_surface_at(const Tubes& tubes, const Hit& hit, const Vec3f& direction) {
  const uint32_t first = tubes.segments[hit.id.primitive];
  const TubeSegment segment(&tubes.points[first]);
  const TubePoint at = tube_point(segment, hit.u, hit.v);
  const double radius = segment.radius(at.w);
  const Vec3d wo = -Vec3d(direction);
  Vec3d t = tangent_at(tubes, hit.id.primitive, at.w);
  const Vec3d ns = upright(at.normal, t, at.normal);
  const Vec3d towards = upright(wo, t, ns);
  // h: sine of the angle from the normal to the viewer about the axis; positive where the viewer is on the
  // side of t × ns against which φ is counted (hair_fibre.h: φ of the normal is φ_o - γ_o).
  const double h = std::clamp(-towards.dot(ns.cross(t)), -1., 1.);

  SurfacePoint point;
  point.id = hit.id;
  point.wo = -direction;
  point.dndu = point.dndv = point.dpdx = point.dpdy = Vec3f(0);
  Vec3d p = segment.centre(at.w) + at.normal * radius;
  if (tubes.facing) {
    // As pbrt's: a ribbon through the axis that faces the ray. Light leaves it from outside the tube.
    p -= towards * (at.normal.dot(towards) * radius);
    point.ng = point.ns = Vec3f(towards);
    point.front = point.back = static_cast<float>(radius);
  } else {
    point.ng = Vec3f(at.normal);
    point.ns = Vec3f(ns);
    point.back = static_cast<float>(2 * radius);
  }
  point.p = Vec3f(p);
  const double largest = std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  point.p_error = Vec3f(static_cast<float>(largest + segment.e.length() + radius) * kRounding);
  const double u0 = tubes.us[first], u1 = tubes.us[first + 1];
  point.uv = {static_cast<float>(u0 + (u1 - u0) * at.w), static_cast<float>(0.5 * (1 + h))};
  point.dpdu = Vec3f(t * (segment.e.length() / (u1 - u0)));
  point.dpdv = Vec3f(Vec3d(point.ns).cross(t) * (2 * radius));
  return point;
}

}  // namespace penumbra
