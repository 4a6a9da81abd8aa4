#pragma once
// A triangle seen from x: its solid angle and Arvo's area-preserving map (Arvo 1995), written in the plane of
// the triangle instead of on the sphere. No angle of the spherical triangle is ever formed, so that slivers
// and tiny triangles keep their digits. Derivations: README.md.
#include "scenes/math.h"

namespace penumbra {

class SphericalTriangle {
 public:
  /// Vertices a, b = a + u, c = a + v; `corner`: a minus x. The edges are given apart, because b − x and c −
  /// x have lost their digits where x is far. The triangle is seen only from the side of u × v; else its
  /// solid angle is 0.
  SphericalTriangle(const Vec3d& corner, const Vec3d& u, const Vec3d& v);
  /// The same with a map that sweeps about the corner: the first number turns the arc through it from edge v to
  /// edge u, so that neighbours in a fan continue each other. (The other constructor starts where most of the
  /// solid angle is.)
  static SphericalTriangle about_corner(const Vec3d& corner, const Vec3d& u, const Vec3d& v) {
    return {corner, u, v, 2};
  }

  /// sr
  double solid_angle() const { return omega_; }
  /// Unit normal, along u × v.
  const Vec3d& normal() const { return normal_; }

  /// Barycentric weights (of b, of c) of a point uniform in solid angle. solid_angle() must not be 0.
  Vec2d sample(const Vec2d& u) const;

 private:
  SphericalTriangle(const Vec3d& corner, const Vec3d& u, const Vec3d& v, int turn);

  Vec3d normal_, a_, b_, edge_, base_;  ///< a, nearest to x; b; c − a; a − b
  int turn_;  ///< a_ is the constructor's vertex number turn_, and the others follow it
  double determinant_, omega_ = 0;
  double a_length_, b_length_, edge_length_;
  double sum_;    ///< |a||b| + a·b
  double slope_;  ///< |b| a·e + |a| b·e, e = c − a
};

}  // namespace penumbra
