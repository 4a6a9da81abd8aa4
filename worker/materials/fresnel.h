#pragma once
// Fresnel reflectance of unpolarised light. The closed set of interfaces a lobe may have; a new one needs
// its name in the variant and an overload of reflectance().
#include <variant>

#include "scenes/math.h"

namespace penumbra {

/// Reflects everything (mirror).
struct FresnelNone {};
/// eta_i: index on the side of the normal (cosθ > 0); eta_t: on the other.
struct FresnelDielectric {
  double eta_i = 1, eta_t = 1.5;
};
/// Complex index eta + i k relative to the outside, per channel. The sign of the cosine is immaterial.
struct FresnelConductor {
  Rgb eta, k;
};

using Fresnel = std::variant<FresnelNone, FresnelDielectric, FresnelConductor>;

/// Reflectance in [0,1] of a dielectric at cosθ_i, measured from the normal; 1 in total internal reflection.
double fresnel_dielectric(double cos_i, double eta_i, double eta_t);
/// Reflectance of a conductor, one channel.
double fresnel_conductor(double cos_i, double eta, double k);
/// ∫ 2 cosθ F(cosθ) dcosθ for light that enters an index of n > 1 from vacuum; Duntley 1942.
double fresnel_diffuse_reflectance(double n);

Rgb reflectance(const Fresnel& fresnel, double cos_i);

}  // namespace penumbra
