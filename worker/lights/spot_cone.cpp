#include "worker/lights/spot_cone.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace penumbra {

/// With w from the apex, inside is w·a >= c |w|: between or beyond the roots of (w·a)² − c²|w|², on the side
/// of the apex that a points to. c >= 0: the cone is convex, so inside is one interval.
bool clip_to_cone(const SpotEmitter& spot, const Vec3d& origin, const Vec3d& direction, double& t0,
                  double& t1) {
  // What arrives is asked in single precision, with the axis' length and the cosine off by some roundings.
  const double c = double{spot.cos_outer} - 16 * double{std::numeric_limits<float>::epsilon()};
  if (!(c > 0)) return t0 < t1;
  const Vec3d w = origin - Vec3d(spot.position), axis(spot.axis);
  const double wa = w.dot(axis), da = direction.dot(axis), c2 = c * c;
  const double a = da * da - c2 * direction.length2();
  const double b = wa * da - c2 * w.dot(direction);
  const double constant = wa * wa - c2 * w.length2();
  const double discriminant = b * b - a * constant;
  if (a < 0 && !(discriminant > 0)) return false;
  const double q = -(b + std::copysign(std::sqrt(std::max(discriminant, 0.)), b));
  if (q == 0 || !std::isfinite(q)) return t0 < t1;  // through the apex, or beyond all numbers: not cut
  const double r0 = std::min(q / a, constant / q), r1 = std::max(q / a, constant / q);
  if (a < 0) {
    if (wa + 0.5 * (r0 + r1) * da < 0) return false;  // the other half of the double cone
    t0 = std::max(t0, r0);
    t1 = std::min(t1, r1);
  } else if (da > 0) {
    t0 = std::max(t0, r1);
  } else {
    t1 = std::min(t1, r0);
  }
  return t0 < t1;
}

}  // namespace penumbra
