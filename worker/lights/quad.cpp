#include "worker/lights/quad.h"

#include <cmath>

#include "worker/lights/plane_distance.h"

namespace penumbra {

bool QuadShape::rectangle() const {
  // A right angle that a transform has rounded: each component of u and v is off by a few units in the last
  // place (2⁻²⁴ relative to the edge's length), which turns the angle by at most a few times that. The
  // density of `sa` on the rectangle then is off by as much, in relative terms.
  const Vec3d a(u), b(v);
  return std::abs(a.dot(b)) <= 0x1p-21 * a.length() * b.length();
}

double area(const QuadShape& shape) {
  return Vec3d(shape.u).cross(Vec3d(shape.v)).length();
}

LightPoint point_at(const QuadShape& shape, const Vec2d& fractions) {
  const Vec3d u(shape.u), v(shape.v);
  return {Vec3d(shape.o) + fractions.x * u + fractions.y * v, u.cross(v).normalized()};
}

LightPoint point_on(const QuadShape& shape, const Vec2d& u) {
  return point_at(shape, u);
}

double height_above(const QuadShape& shape, const Vec3d& x, const Vec3d&, const Vec3d&) {
  return distance_in_front(x - Vec3d(shape.o), Vec3d(shape.u), Vec3d(shape.v));
}

}  // namespace penumbra
