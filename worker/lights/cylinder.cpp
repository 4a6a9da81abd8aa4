#include "worker/lights/cylinder.h"

#include <cmath>
#include <numbers>

#include "worker/sampling/warp.h"

namespace penumbra {

using std::numbers::pi;

double area(const CylinderShape& shape) {
  return 2 * pi * shape.radius * Vec3d(shape.axis).length();
}

LightPoint point_on(const CylinderShape& shape, const Vec2d& u) {
  const Vec3d axis(shape.axis);
  Vec3d s, t;
  frame(axis.normalized(), s, t);
  const double phi = 2 * pi * u.y;
  const Vec3d outwards = std::cos(phi) * s + std::sin(phi) * t;
  return {Vec3d(shape.base) + u.x * axis + static_cast<double>(shape.radius) * outwards,
          shape.inwards ? -outwards : outwards};
}

double height_above(const CylinderShape& shape, const Vec3d& x, const Vec3d&, const Vec3d& n) {
  // (x − p)·n, p = base + (something along the axis, ⟂ n) ± r n, without the rounding of p.
  const double radius = shape.radius;
  return (x - Vec3d(shape.base)).dot(n) - (shape.inwards ? -radius : radius);
}

}  // namespace penumbra
