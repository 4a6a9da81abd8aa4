#include "worker/lights/triangle_fan.h"

#include <algorithm>
#include <cmath>

#include "worker/lights/chord_measure.h"
#include "worker/lights/plane_side.h"

namespace penumbra {

TriangleFan::TriangleFan(const TriangleShape& triangle, const Vec3d& x, bool along_u, double solid_angle)
    : corner_(along_u ? triangle.p1 : triangle.p2), solid_angle_(solid_angle) {
  const Vec3d p0(triangle.p0), other(along_u ? triangle.p2 : triangle.p1);
  apex_ = corner_ - x;
  first_ = p0 - x;
  last_ = other - x;
  to_first_ = p0 - corner_;
  to_last_ = other - corner_;
  const PlaneSide side = side_of_plane(x - p0, Vec3d(triangle.p1) - p0, Vec3d(triangle.p2) - p0);
  normal_ = side.normal;
  determinant_ = side.distance * side.twice_area;
}

LightLine TriangleFan::chord_to(const Vec3d& from_apex) const {
  LightLine line;
  line.corner = line.a = corner_;
  line.along = from_apex;
  line.b = corner_ + from_apex;
  line.n = normal_;
  line.scale = 1 / solid_angle_;
  const double length = from_apex.length();
  if (!(length > 0)) return {};
  const double t0 = apex_.dot(from_apex) / length, d = apex_.cross(from_apex).length() / length;
  line.measure = ApexMeasure{t0, length, d, versine_difference(t0, d, 0, length)};
  return line;
}

/// The fraction t of the edge from `start` at which the triangle (apex, start, start + t edge) has the solid
/// angle u Ω. README.md, «Triangle»: with γ = sin(σ/2) (|a||b| + a·b) and α = cos(σ/2) det − sin(σ/2) (|b|
/// a·e + |a| b·e), t = 2γ (α|a| + γ a·e) / ((α − γ|e|)(α + γ|e|)), a the start, b the apex.
double TriangleFan::opposite_fraction(double u, const Vec3d& start, const Vec3d& edge) const {
  const double a = start.length(), b = apex_.length(), e = edge.length(),
               s = std::sin(0.5 * u * solid_angle_);
  const double gamma = s * (a * b + start.dot(apex_));
  const double alpha =
      std::cos(0.5 * u * solid_angle_) * determinant_ - s * (b * start.dot(edge) + a * apex_.dot(edge));
  const double numerator = 2 * gamma * (alpha * a + gamma * start.dot(edge));
  const double denominator = (alpha - gamma * e) * (alpha + gamma * e);
  return numerator < denominator ? std::max(numerator / denominator, 0.0) : 1.0;
}

LightLine TriangleFan::choose(double u) const {
  const Vec3d edge = to_last_ - to_first_;
  // From the nearer end, where most of the solid angle is: README.md.
  if (first_.length2() <= last_.length2())
    return chord_to(to_first_ + opposite_fraction(u, first_, edge) * edge);
  return chord_to(to_last_ - opposite_fraction(1 - u, last_, -edge) * edge);
}

LightLine TriangleFan::through(const Vec3d& p) const {
  // p − apex = f to_first + g to_last; its chord ends at the edge across, where f + g = 1.
  const Vec3d d = p - corner_;
  const double f = std::max(d.cross(to_last_).dot(to_first_.cross(to_last_)), 0.0);
  const double g = std::max(to_first_.cross(d).dot(to_first_.cross(to_last_)), 0.0);
  if (!(f + g > 0)) return {};
  return chord_to((f * to_first_ + g * to_last_) / (f + g));
}

}  // namespace penumbra
