#pragma once
// Colorimetry: spectra to linear RGB of Rec. 709 primaries.
#include <span>

#include "scenes/math.h"

namespace penumbra {

constexpr double kLeastWavelength = 360, kMostWavelength = 830;  ///< nm, of the CIE's tables

/// CIE 1931 2° colour matching functions at a wavelength in nm: the multi-lobe fit of Wyman, Sloan and
/// Shirley 2013 (JCGT 2(2), eq. 2), within the spread of the human observers behind the tables.
Vec3d color_matching(double nm);

/// XYZ to linear Rec. 709 (IEC 61966-2-1).
Rgb rgb_of_xyz(const Vec3d& xyz);

/// A spectrum as samples, wavelengths in nm in ascending order; constant beyond the ends, as in pbrt.
struct SampledSpectrum {
  std::span<const double> wavelengths, values;
};

/// Linear RGB with Y = ∫ s ȳ dλ / ∫ ȳ dλ (pbrt-v3: the constant spectrum 1 has Y = 1, white of illuminant E).
Rgb rgb_of_spectrum(const SampledSpectrum& spectrum);

/// Planck's law, scaled so that its greatest value over all wavelengths is 1 (pbrt-v3's emitters).
Rgb rgb_of_blackbody(double kelvin);

/// Rec. 709 luminance.
inline float luminance(const Rgb& c) {
  return 0.212671f * c.x + 0.715160f * c.y + 0.072169f * c.z;
}

}  // namespace penumbra
