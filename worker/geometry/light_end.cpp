#include "worker/geometry/light_end.h"

#include <algorithm>
#include <cmath>

#include "worker/geometry/line_fan.h"

namespace penumbra {

// The doubt. A ray's distance to a plane is a quotient of n · (p0 - x), whose rounding (of the vertices, of n
// as a cross product, of the sum) is a few units of the last place of the largest length in it: 32 u of the
// light's coordinates and the distance from x (as sums, which are no less), over the height of x, for what is
// parallel to the light. For what is not, and because judging a hit costs less than finding it, no less than
// 2^-11 of the way; and no more than half of it, so that a light seen from its own plane hides behind what is
// clearly before it.

// The segment crosses the surface's plane at 1 - s of its length, so s · height before the light's plane: in
// double, from differences that single-precision vertices give exactly or to 2^-53.
//
// How far before counts as before? Vertices are rounded to single precision, each coordinate by at most u of
// itself, and a point inside a triangle is off by no more than its vertices; along the light's normal that is
// u Σ|n_k| |v_k|, for the surface and for the light. The light's points lie on corner + edges, the edges
// rounded from differences: another u Σ|n_k| (extent_u + extent_v)_k. Two surfaces that the scene has in one
// plane are no farther apart than the sum, and neither hides the other.
bool LightApproach::hides(const Vec3d surface[3], const Imath::Box3f& light) const {
  double coplanar = 0;
  for (int k = 0; k < 3; ++k) {
    const double lo = light.min[k], hi = light.max[k];
    const double own = std::max(std::abs(lo), std::abs(hi)) + 2 * (hi - lo);
    const double met = std::max({std::abs(surface[0][k]), std::abs(surface[1][k]), std::abs(surface[2][k])});
    coplanar += kFloatRoundoff * std::abs(end_.n[k]) * (own + met);
  }
  const Vec3d n = (surface[1] - surface[0]).cross(surface[2] - surface[0]);
  const Vec3d way = end_.p - Vec3d(x_);
  const double height = std::abs(end_.n.dot(way)), along = n.dot(way), beyond = n.dot(end_.p - surface[0]);
  // beyond / along · height > coplanar; along = 0: the segment runs in the surface, which does not cut it.
  return along < 0 ? beyond * height < coplanar * along : beyond * height > coplanar * along;
}

}  // namespace penumbra
