#include "worker/lights/sphere.h"

#include <numbers>

#include "worker/sampling/warp.h"

namespace penumbra {

double area(const SphereShape& shape) {
  const double r = shape.radius;
  return 4 * std::numbers::pi * r * r;
}

LightPoint point_at(const SphereShape& shape, const Vec3d& n) {
  return {Vec3d(shape.center) + static_cast<double>(shape.radius) * n, shape.inwards ? -n : n};
}

LightPoint point_on(const SphereShape& shape, const Vec2d& u) {
  return point_at(shape, square_to_sphere(u));
}

double height_above(const SphereShape& shape, const Vec3d& x, const Vec3d&, const Vec3d& n) {
  // (x − p)·n, p = c ± r n, without the rounding of p.
  const double radius = shape.radius;
  return (x - Vec3d(shape.center)).dot(n) - (shape.inwards ? -radius : radius);
}

}  // namespace penumbra
