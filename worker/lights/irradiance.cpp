#include "worker/lights/irradiance.h"

#include <algorithm>
#include <cmath>

#include "worker/lights/convex_polygon.h"
#include "worker/lights/plane_side.h"
#include "worker/lights/quad.h"
#include "worker/lights/triangle.h"

namespace penumbra {
namespace {

/// A flat light minus x, if x is in front of it.
struct FlatLight {
  ConvexPolygon polygon;
  Vec3d normal;  ///< emission side; any length
  bool in_front = false;
};

FlatLight flat_light(const LightShape& shape, const Vec3d& x) {
  FlatLight light;
  Vec3d o, u, v;
  if (const auto* quad = std::get_if<QuadShape>(&shape)) {
    o = Vec3d(quad->o) - x;
    u = Vec3d(quad->u);
    v = Vec3d(quad->v);
    light.polygon = {o, o + u, o + u + v, o + v};
  } else {
    const auto& triangle = std::get<TriangleShape>(shape);
    o = Vec3d(triangle.p0) - x;
    u = Vec3d(triangle.p1) - Vec3d(triangle.p0);
    v = Vec3d(triangle.p2) - Vec3d(triangle.p0);
    light.polygon = {o, o + u, o + v};
  }
  light.normal = u.cross(v);
  light.in_front = side_of_plane(-o, u, v).distance > 0;
  return light;
}

/// Lambert's sum: half of n · Σ θ_i ĉ_i over the edges a→b, c = a × b perpendicular to the edge's plane and θ
/// the angle between a and b. b − a has no rounding of its own to speak of, so |c| = |a × (b − a)| is good
/// where a × b would cancel. Corners clockwise as seen from x.
double edge_sum(std::span<const Vec3d> corners, const Vec3d& n) {
  double sum = 0;
  for (size_t i = 0; i < corners.size(); ++i) {
    const Vec3d &a = corners[i], &b = corners[(i + 1) % corners.size()];
    const Vec3d c = (b - a).cross(a);
    const double length = c.length();
    if (length > 0) sum += std::atan2(length, a.dot(b)) / length * n.dot(c);
  }
  return 0.5 * sum;
}

/// One triangle by Radon's seven-point rule, exact to degree 5: ∫ (n·p)(N·p)/|p|⁴ dA, where N·p is constant.
double quadrature(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& n) {
  constexpr double kRoot = 3.872983346207416885;  // √15
  constexpr double kInner = (6 - kRoot) / 21, kOuter = (6 + kRoot) / 21;
  constexpr double kInnerWeight = (155 - kRoot) / 1200, kOuterWeight = (155 + kRoot) / 1200;
  const Vec3d u = b - a, v = c - a;
  const auto term = [&](double s, double t) {
    const Vec3d p = a + s * u + t * v;
    const double r2 = p.length2();
    return n.dot(p) / (r2 * r2);
  };
  const double sum =
      0.225 * term(1.0 / 3, 1.0 / 3) +
      kInnerWeight * (term(kInner, kInner) + term(1 - 2 * kInner, kInner) + term(kInner, 1 - 2 * kInner)) +
      kOuterWeight * (term(kOuter, kOuter) + term(1 - 2 * kOuter, kOuter) + term(kOuter, 1 - 2 * kOuter));
  return 0.5 * sum * std::abs(u.cross(v).dot(a));
}

/// Of a polygon that lies above the horizon.
double polygon_irradiance(const ConvexPolygon& polygon, const Vec3d& n) {
  if (polygon.empty()) return 0;
  const std::span<const Vec3d> corners = polygon.corners();
  double extent2 = 0, distance2 = corners[0].length2();
  for (const Vec3d& c : corners) {
    extent2 = std::max(extent2, (c - corners[0]).length2());
    distance2 = std::min(distance2, c.length2());
  }
  // The edges' terms are of the order of the extent δ = extent/distance and cancel to the order of δ², losing
  // 1/δ digits; the rule's relative error is of the order of δ⁶. They meet near δ = 0.02.
  constexpr double kFewest = 0.02;
  if (extent2 < kFewest * kFewest * distance2) {
    double sum = 0;
    for (size_t i = 2; i < corners.size(); ++i) sum += quadrature(corners[0], corners[i - 1], corners[i], n);
    return sum;
  }
  return std::max(0.0,
                  edge_sum(corners, n));  // not negative but for rounding: the polygon is above the horizon
}

}  // namespace

bool has_irradiance(const LightShape& shape) {
  return std::holds_alternative<QuadShape>(shape) || std::holds_alternative<TriangleShape>(shape);
}

double irradiance(const LightShape& shape, const Vec3d& x, const Vec3d& n) {
  PENUMBRA_CHECK(has_irradiance(shape));
  const FlatLight light = flat_light(shape, x);
  return light.in_front ? polygon_irradiance(clip(light.polygon, n), n) : 0;
}

double irradiance_behind(const LightShape& shape, const Vec3d& x, const Vec3d& n,
                         const std::array<Vec3d, 3>& occluder) {
  PENUMBRA_CHECK(has_irradiance(shape));
  const FlatLight light = flat_light(shape, x);
  if (!light.in_front) return 0;
  ConvexPolygon lit = clip(light.polygon, n);

  // Only what lies on x's side of the light's plane can hide. Its shadow is the cone over it, an
  // intersection of half-spaces through x, wherever its corners are: those behind x bound the cone, too.
  const Vec3d a = occluder[0] - x, b = occluder[1] - x, c = occluder[2] - x;
  const ConvexPolygon blocker = clip({a, b, c}, light.normal, light.normal.dot(light.polygon.corners()[0]));
  const double turn = a.dot((b - a).cross(c - a));
  if (blocker.empty() || turn == 0) return polygon_irradiance(lit, n);

  // The lit part in convex pieces: outside the first side, inside the first and outside the second, …
  double sum = 0;
  const std::span<const Vec3d> corners = blocker.corners();
  for (size_t i = 0; i < corners.size() && !lit.empty(); ++i) {
    const Vec3d &p = corners[i], &q = corners[(i + 1) % corners.size()];
    const Vec3d inwards = turn > 0 ? p.cross(q - p) : (q - p).cross(p);
    sum += polygon_irradiance(clip(lit, -inwards), n);
    lit = clip(lit, inwards);
  }
  return sum;
}

}  // namespace penumbra
