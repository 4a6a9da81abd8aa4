#include "worker/lights/convex_polygon.h"

namespace penumbra {

ConvexPolygon clip(const ConvexPolygon& polygon, const Vec3d& normal, double height) {
  // Sutherland & Hodgman 1974, one plane. A crossing edge has ends of opposite signs: nothing cancels.
  ConvexPolygon inside;
  const std::span<const Vec3d> corners = polygon.corners();
  for (size_t i = 0; i < corners.size(); ++i) {
    const Vec3d &a = corners[i], &b = corners[(i + 1) % corners.size()];
    const double above_a = normal.dot(a) - height, above_b = normal.dot(b) - height;
    if (above_a >= 0) inside.push_back(a);
    if ((above_a > 0 && above_b < 0) || (above_a < 0 && above_b > 0))
      inside.push_back(a + above_a / (above_a - above_b) * (b - a));
  }
  return inside;
}

}  // namespace penumbra
