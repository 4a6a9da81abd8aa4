#include "worker/lights/disk.h"

#include <cmath>
#include <numbers>

#include "worker/sampling/warp.h"

namespace penumbra {

using std::numbers::pi;

double area(const DiskShape& shape) {
  const double outer = shape.radius, inner = shape.inner;
  return pi * (outer - inner) * (outer + inner);
}

LightPoint point_on(const DiskShape& shape, const Vec2d& u) {
  const double outer = shape.radius, inner = shape.inner;
  Vec2d q;
  if (inner == 0) {
    q = outer * square_to_disk_concentric(u);
  } else {
    const double r = std::sqrt((1 - u.x) * inner * inner + u.x * outer * outer), phi = 2 * pi * u.y;
    q = {r * std::cos(phi), r * std::sin(phi)};
  }
  const Vec3d n = Vec3d(shape.n).normalized();
  Vec3d s, t;
  frame(n, s, t);
  return {Vec3d(shape.center) + q.x * s + q.y * t, n};
}

double height_above(const DiskShape& shape, const Vec3d& x, const Vec3d&, const Vec3d&) {
  return (x - Vec3d(shape.center)).dot(Vec3d(shape.n).normalized());
}

}  // namespace penumbra
