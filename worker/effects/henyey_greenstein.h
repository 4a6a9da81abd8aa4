#pragma once
// The phase function of Henyey & Greenstein 1941: how a medium scatters. Per solid angle, and its own
// density: its integral over the sphere is 1.
#include "scenes/math.h"

namespace penumbra {

struct HenyeyGreenstein {
  double g = 0;  ///< mean cosine of the deflection, in (-1,1); 0: isotropic
};

/// sr⁻¹. Both directions unit, away from the point: light that goes straight on has wi = -wo. Also the
/// density of sample(). Directions that are rounded to single precision keep their digits at the peak,
/// because only the distance from it enters: 1 + wo·wi = |wo + wi|²/2.
double phase(const HenyeyGreenstein& hg, const Vec3f& wo, const Vec3f& wi);

/// A direction with density phase().
Vec3f sample(const HenyeyGreenstein& hg, const Vec3f& wo, const Vec2d& u);

}  // namespace penumbra
