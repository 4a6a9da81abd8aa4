#include "worker/geometry/light_end.h"

#include "worker/geometry/light_plane.h"

namespace penumbra {

// The doubt. A ray's distance to a plane is a quotient of n · (p0 - x), whose rounding (of the vertices, of n
// as a cross product, of the sum) is a few units of the last place of the largest length in it: 32 u of the
// light's coordinates, the distance from x and the extent of surfaces (as sums, which are no less), over the
// height of x, for what is parallel to the light. For what is not, no less than 2^-11 of the way; and no more
// than half of it. Judging a hit costs less than finding it: on this side of the light, all of the second
// half is.
//
// Where nothing else is that close to the light the ray ends so far before it and needs no judge. A surface
// that stands askew may be met within the doubt of another place; that moves its shadow's edge by as little.

// The segment crosses the surface's plane at 1 - s of its length, so s · height before the light's plane: in
// double, from differences that single-precision vertices give exactly or to 2^-53. It counts from the
// rounding of vertices on (light_plane.h).
bool LightApproach::hides(const Vec3d surface[3]) const {
  const Vec3d& normal = end_.plane.normal;
  double met = 0;
  for (int i = 0; i < 3; ++i) met = std::max(met, rounding_along(normal, surface[i]));
  const double coplanar = end_.plane.rounding + met;
  const Vec3d n = (surface[1] - surface[0]).cross(surface[2] - surface[0]);
  const Vec3d way = end_.p - Vec3d(x_);
  const double height = std::abs(normal.dot(way)), along = n.dot(way), beyond = n.dot(end_.p - surface[0]);
  // beyond / along · height > coplanar; along = 0: the segment runs in the surface, which does not cut it.
  return along < 0 ? beyond * height < coplanar * along : beyond * height > coplanar * along;
}

}  // namespace penumbra
