#pragma once
#include "worker/lights/shape.h"

namespace penumbra {

double area(const QuadShape& shape);
/// A point uniform in area, with the normal on the emission side; pdf is left 0.
LightPoint point_on(const QuadShape& shape, const Vec2d& u);
/// Distance of x in front of the tangent plane at p (on the shape, unit normal n); not positive: not seen.
double height_above(const QuadShape& shape, const Vec3d& x, const Vec3d& p, const Vec3d& n);
/// The point at fractions of u and v.
Vec3d position_at(const QuadShape& shape, const Vec2d& fractions);

}  // namespace penumbra
