#include "worker/materials/phong.h"

#include <cmath>
#include <numbers>

namespace penumbra {

// r·wi = 1 - |wi - r|²/2 for unit vectors: for exponents of 10⁶ the lobe lives where r·wi has lost the
// digits that its difference from 1 still has, so the power is taken of that difference.
double phong(double exponent, const Vec3d& wo, const Vec3d& wi) {
  const Vec3d mirrored(-wo.x, -wo.y, wo.z);
  const double difference = (wi - mirrored).length2() / 2;
  if (difference >= 1) return 0;
  return (exponent + 2) / (2 * std::numbers::pi) * std::exp(exponent * std::log1p(-difference));
}

}  // namespace penumbra
