#include "worker/render/tube_surface.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "worker/geometry/tube.h"

namespace penumbra {
namespace {

/// Bound of the rounding of a point of a tube, per coordinate: half a unit in the last place of the largest
/// one, for the axis' points (as the scene has them), the point itself and its offset each. What rays meet of
/// tubes is decided in double (geometry/embree_scene.cpp), so nothing of Embree's own rounding is in it.
constexpr float kRounding = 4 * std::numeric_limits<float>::epsilon() / 2;

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

/// Along the normal from a side of radius r through to the other one. That is 2 r, but for a cone of half
/// angle β, where the normal leans by β and leads to where it is wider: b cosβ - r cosβ = r cosβ + b sinβ
/// tanβ.
double through(const TubeSegment& s, double radius) {
  if (!s.has_side()) return 2 * radius;
  const double sin2 = s.dr * s.dr / s.e.length2(), cos2 = 1 - sin2;
  return cos2 > 2 * sin2 ? 2 * radius * cos2 / (cos2 - sin2) : 4 * radius;
}

}  // namespace

SurfacePoint tube_surface_at(const Tubes& tubes, const Hit& hit, const Vec3f& direction) {
  const uint32_t first = tubes.segments[hit.id.primitive];
  const TubeSegment segment(&tubes.points[first]);
  const TubePoint at = tube_point(segment, hit.u, hit.v);
  const double radius = segment.radius(at.w);
  const Vec3d wo = -Vec3d(direction);
  Vec3d t = tangent_at(tubes, hit.id.primitive, at.w);
  const Vec3d ns = upright(at.normal, t, at.normal), towards = upright(wo, t, ns);
  // h: sine of the angle from the normal to the viewer about the axis; positive where the viewer is on the
  // side of t × ns against which φ is counted (hair_fibre.h: φ of the normal is φ_o - γ_o).
  const double h = std::clamp(-towards.dot(ns.cross(t)), -1., 1.);

  SurfacePoint point;
  point.id = hit.id;
  point.time = hit.time;
  point.wo = -direction;
  point.dndu = point.dndv = point.dpdx = point.dpdy = Vec3f(0);
  Vec3d p = segment.centre(at.w) + at.normal * radius;
  if (tubes.facing) {
    // As pbrt's: a ribbon through the axis that faces the ray. Light leaves it from outside the tube, so the
    // plane is at right angles to the segment itself, not to the blended tangent.
    const Vec3d ng = upright(wo, segment.e.normalized(), ns);
    p -= ng * (at.normal.dot(ng) * radius);
    point.ng = Vec3f(ng);
    point.ns = Vec3f(towards);
    point.front = point.back = static_cast<float>(radius);
  } else {
    point.ng = Vec3f(at.normal);
    point.ns = Vec3f(ns);
    point.back = static_cast<float>(through(segment, radius));
  }
  point.p = Vec3f(p);
  const double largest = std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  point.p_error = Vec3f(static_cast<float>(largest + radius) * kRounding);
  const double u0 = tubes.us[first], u1 = tubes.us[first + 1];
  point.uv = {static_cast<float>(u0 + (u1 - u0) * at.w), static_cast<float>(0.5 * (1 + h))};
  point.dpdu = Vec3f(t * (segment.e.length() / (u1 - u0)));
  point.dpdv = Vec3f(Vec3d(point.ns).cross(t) * (2 * radius));
  return point;
}

}  // namespace penumbra
