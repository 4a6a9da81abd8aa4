#pragma once
#include "worker/lights/shape.h"

namespace penumbra {

double area(const TriangleShape& shape);
/// A point uniform in area, with the normal on the emission side; pdf is left 0.
LightPoint point_on(const TriangleShape& shape, const Vec2d& u);
/// Distance of x in front of the tangent plane at p (on the shape, unit normal n); not positive: not seen.
double height_above(const TriangleShape& shape, const Vec3d& x, const Vec3d& p, const Vec3d& n);
/// The point with barycentric weights (of p1, of p2).
Vec3d position_at(const TriangleShape& shape, const Vec2d& weights);

}  // namespace penumbra
