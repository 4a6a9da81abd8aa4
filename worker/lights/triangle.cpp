#include "worker/lights/triangle.h"

#include "worker/lights/plane_side.h"
#include "worker/sampling/warp.h"

namespace penumbra {
namespace {

struct Edges {
  Vec3d u, v;
};
Edges edges_of(const TriangleShape& shape) {
  return {Vec3d(shape.p1) - Vec3d(shape.p0), Vec3d(shape.p2) - Vec3d(shape.p0)};
}

}  // namespace

double area(const TriangleShape& shape) {
  const Edges e = edges_of(shape);
  return 0.5 * e.u.cross(e.v).length();
}

Vec3d position_at(const TriangleShape& shape, const Vec2d& weights) {
  const Edges e = edges_of(shape);
  return Vec3d(shape.p0) + (weights.x * e.u + weights.y * e.v);
}

LightPoint point_on(const TriangleShape& shape, const Vec2d& u) {
  const Edges e = edges_of(shape);
  return {position_at(shape, square_to_triangle(u)), e.u.cross(e.v).normalized()};
}

double height_above(const TriangleShape& shape, const Vec3d& x, const Vec3d&, const Vec3d&) {
  const Edges e = edges_of(shape);
  return side_of_plane(x - Vec3d(shape.p0), e.u, e.v).distance;
}

}  // namespace penumbra
