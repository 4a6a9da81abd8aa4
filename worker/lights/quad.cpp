#include "worker/lights/quad.h"

#include <cmath>

#include "worker/lights/plane_side.h"

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

Vec3d position_at(const QuadShape& shape, const Vec2d& fractions) {
  return Vec3d(shape.o) + (fractions.x * Vec3d(shape.u) + fractions.y * Vec3d(shape.v));
}

LightPoint point_on(const QuadShape& shape, const Vec2d& u) {
  return {position_at(shape, u), Vec3d(shape.u).cross(Vec3d(shape.v)).normalized()};
}

double height_above(const QuadShape& shape, const Vec3d& x, const Vec3d&, const Vec3d&) {
  return side_of_plane(x - Vec3d(shape.o), Vec3d(shape.u), Vec3d(shape.v)).distance;
}

}  // namespace penumbra
