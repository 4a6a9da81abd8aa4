#pragma once
// Solid-angle lines on a triangle: the chords through one vertex, the apex. In Arvo's map (1995) the first
// dimension cuts the spherical triangle by a great arc through a vertex, uniform in the solid angle on one
// side; that arc is the image of a chord of the triangle, and along it the density goes with 1 − cosθ, θ from
// the apex. SJ19 leave solid-angle lines on triangles open; these are some.
#include "worker/lights/line.h"

namespace penumbra {

class TriangleFan {
 public:
  /// `@u`: the apex is p1, so that edge u is the fan's first chord; `@v`: p2 and edge v. `solid_angle`: of
  /// the triangle seen from x, > 0.
  TriangleFan(const TriangleShape& triangle, const Vec3d& x, bool along_u, double solid_angle);

  /// The chord at the quantile u of the solid angle swept from the apex' edge to p0.
  LightLine choose(double u) const;
  /// The chord through p; none through the apex itself.
  LightLine through(const Vec3d& p) const;

 private:
  LightLine chord_to(const Vec3d& from_apex) const;
  double opposite_fraction(double u, const Vec3d& start, const Vec3d& edge) const;

  Vec3d corner_;               ///< the apex, world
  Vec3d apex_, first_, last_;  ///< minus x: the apex and the ends of the edge across from it
  Vec3d to_first_, to_last_;   ///< from the apex
  Vec3d normal_;
  double determinant_, solid_angle_;
};

}  // namespace penumbra
