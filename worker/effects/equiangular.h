#pragma once
// Distances along a ray by the angle at a point beside it.
#include "worker/effects/density.h"

namespace penumbra {

/// Distances uniform in the angle at a pivot (Kulla & Fajardo 2012): in proportion to 1/r², r the distance to
/// it.
class Equiangular {
 public:
  Equiangular(const MediumRay& ray, const Vec3d& pivot);
  /// A pivot on the ray's line, or a part of no length: no density.
  bool possible() const { return height_ > 0 && angle_ > 0; }
  /// Of the ray at the pivot.
  double angle() const { return angle_; }
  double sample(double u) const;
  /// Density of sample() at t in [t0,t1], per length.
  double pdf(double t) const;

 private:
  double t0_, t1_;
  double first_ = 0;   ///< t0 − t of the pivot's foot
  double height_ = 0;  ///< distance of the pivot from the ray's line
  double angle_ = 0;   ///< between the directions to both ends
};

}  // namespace penumbra
