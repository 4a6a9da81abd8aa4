#pragma once
// The shading frame: z along the shading normal. Lobes work here, in double, so that narrow lobes keep
// their digits; z is never reconstructed from 1 - x² - y² or the reverse, which cancels near the pole.
#include <cmath>

#include "scenes/math.h"

namespace penumbra {

/// Below this a direction lies in the plane: unit vectors in single precision are good to 2⁻²⁴, so a cosine
/// this small is rounding, and 1/(cosθ_i cosθ_o) of it times any D of ours is still finite as a float.
constexpr double kLeastCosine = 0x1p-40;

inline double abs_cos(const Vec3d& w) {
  return std::abs(w.z);
}
inline double sin2(const Vec3d& w) {
  return w.x * w.x + w.y * w.y;
}
inline bool same_hemisphere(const Vec3d& a, const Vec3d& b) {
  return a.z * b.z > 0;
}

/// w mirrored about h (both away from the surface).
inline Vec3d reflected(const Vec3d& w, const Vec3d& h) {
  return h * (2 * (w ^ h)) - w;
}

/// Direction of w after refraction at a facet with unit normal n on w's side; eta = η(w's side) / η(far
/// side). False: total internal reflection.
inline bool refracted(const Vec3d& w, const Vec3d& n, double eta, Vec3d& out) {
  const double cos_i = w ^ n;
  // sin²θ_i as |w × n|²: keeps its digits where 1 - cos² would cancel.
  const double sin2_t = eta * eta * (w % n).length2();
  if (sin2_t >= 1) return false;
  out = w * -eta + n * (eta * cos_i - std::sqrt(1 - sin2_t));
  return true;
}

}  // namespace penumbra
