#pragma once
// One axis of UFK13's parametrisation: an offset across a rectangle, uniform in the solid angle of the strip
// that it sweeps.
#include "worker/lights/half_angle.h"

namespace penumbra {

class OffsetWarp {
 public:
  /// The rectangle [x0, x0+w] × [y0, y0+h] at distance z > 0 of x, all lengths from the foot of x; `omega`:
  /// its solid angle, > 0.
  OffsetWarp(double x0, double w, double y0, double h, double z, double omega);

  struct Offset {
    double t;  ///< from the rectangle's edge, in [0,w]
    double x;  ///< from the foot of x: x0 + t, but accurate relative to z where the foot is near
  };
  /// The strip [x0, x0+t] has the solid angle u·omega.
  Offset sample(double u) const;

 private:
  Offset sample_from_near_end(double u) const;
  double sin_half(const HalfAngle& a, const HalfAngle& b) const;
  double sin_half_raised(const HalfAngle& a, const HalfAngle& b) const;

  // The frame after mirroring: |x0| <= |x0 + w| and y0 + y1 >= 0.
  double x0_, w_, z_, half_omega_;
  bool mirrored_, foot_is_near_;
  HalfAngle left_, beyond_;  ///< solid angles of the infinite band left of x0 and right of x0 + w
  HalfAngle top_, bottom_;  ///< (not halves) elevations of the plane over the band's edges: tan = z/y1, z/−y0
  double rho0_, b0_, sin_left_, sin_right_;
};

}  // namespace penumbra
