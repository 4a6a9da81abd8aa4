#include "worker/lights/triangle.h"

#include "worker/lights/plane_distance.h"
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

LightPoint point_at(const TriangleShape& shape, const Vec2d& weights) {
  const Edges e = edges_of(shape);
  return {Vec3d(shape.p0) + weights.x * e.u + weights.y * e.v, e.u.cross(e.v).normalized()};
}

LightPoint point_on(const TriangleShape& shape, const Vec2d& u) {
  return point_at(shape, square_to_triangle(u));
}

double height_above(const TriangleShape& shape, const Vec3d& x, const Vec3d&, const Vec3d&) {
  const Edges e = edges_of(shape);
  return distance_in_front(x - Vec3d(shape.p0), e.u, e.v);
}

}  // namespace penumbra
