#pragma once
#include "scenes/math.h"

namespace penumbra {

/// The modified Phong lobe of Lafortune & Willems 1994 without colour, (e + 2)/2π max(0, r·wi)^e with r the
/// mirror direction of wo: per solid angle, for Billen & Dutré's analytic line integrals. No material has it.
double phong(double exponent, const Vec3d& wo, const Vec3d& wi);

}  // namespace penumbra
