#pragma once
// A sphere seen from x: the cone of directions that meet it from outside, all directions from inside.
#include "scenes/math.h"

namespace penumbra {

class VisibleSphere {
 public:
  /// `center`: minus x. An inward-emitting sphere is seen from inside only, an outward one from outside only.
  VisibleSphere(const Vec3d& center, double radius, bool inwards);

  /// sr; 2π(1 − cosθ_max) outside, 4π inside.
  double solid_angle() const { return omega_; }

  /// Unit normal (outwards) of a point uniform in solid angle; the point is center + radius · normal.
  /// solid_angle() must not be 0.
  Vec3d sample_normal(const Vec2d& u) const;

 private:
  Vec3d sample_from_outside(const Vec2d& u) const;
  Vec3d sample_from_inside(const Vec2d& u) const;

  Vec3d center_;
  double distance_, radius_, one_minus_cos_ = 0, omega_ = 0;
};

}  // namespace penumbra
