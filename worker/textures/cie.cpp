#include "worker/textures/cie.h"

#include <algorithm>
#include <cmath>

namespace penumbra {
namespace {

/// Gaussian with different widths on its two sides; `left`, `right` are inverse widths in nm⁻¹.
double lobe(double nm, double center, double left, double right) {
  const double t = (nm - center) * (nm < center ? left : right);
  return std::exp(-0.5 * t * t);
}

double value_at(const SampledSpectrum& s, double nm) {
  const auto& w = s.wavelengths;
  const auto above = std::upper_bound(w.begin(), w.end(), nm);
  if (above == w.begin()) return s.values.front();
  if (above == w.end()) return s.values.back();
  const size_t i = static_cast<size_t>(above - w.begin());
  const double t = (nm - w[i - 1]) / (w[i] - w[i - 1]);
  return s.values[i - 1] + t * (s.values[i] - s.values[i - 1]);
}

/// XYZ of a spectrum by the rectangle rule at 1 nm, which is the CIE's own.
template <class Spectrum>
Vec3d xyz_of(const Spectrum& spectrum) {
  Vec3d sum(0);
  double white = 0;
  for (double nm = kLeastWavelength; nm <= kMostWavelength; nm += 1) {
    const Vec3d cmf = color_matching(nm);
    sum += cmf * spectrum(nm);
    white += cmf.y;
  }
  return sum / white;
}

}  // namespace

Vec3d color_matching(double nm) {
  return {0.362 * lobe(nm, 442.0, 0.0624, 0.0374) + 1.056 * lobe(nm, 599.8, 0.0264, 0.0323) -
              0.065 * lobe(nm, 501.1, 0.0490, 0.0382),
          0.821 * lobe(nm, 568.8, 0.0213, 0.0247) + 0.286 * lobe(nm, 530.9, 0.0613, 0.0322),
          1.217 * lobe(nm, 437.0, 0.0845, 0.0278) + 0.681 * lobe(nm, 459.0, 0.0385, 0.0725)};
}

Rgb rgb_of_xyz(const Vec3d& c) {
  return Rgb(static_cast<float>(3.240479 * c.x - 1.537150 * c.y - 0.498535 * c.z),
             static_cast<float>(-0.969256 * c.x + 1.875991 * c.y + 0.041556 * c.z),
             static_cast<float>(0.055648 * c.x - 0.204043 * c.y + 1.057311 * c.z));
}

Rgb rgb_of_spectrum(const SampledSpectrum& spectrum) {
  return rgb_of_xyz(xyz_of([&](double nm) { return value_at(spectrum, nm); }));
}

Rgb rgb_of_blackbody(double kelvin) {
  constexpr double kPlanck = 6.62606957e-34, kLight = 299792458, kBoltzmann = 1.3806488e-23;
  constexpr double kWien = 2.8977721e-3;  // metre kelvin
  const auto planck = [&](double metres) {
    return 1 / (std::pow(metres, 5) * std::expm1(kPlanck * kLight / (metres * kBoltzmann * kelvin)));
  };
  const double peak = planck(kWien / kelvin);
  return rgb_of_xyz(xyz_of([&](double nm) { return planck(nm * 1e-9) / peak; }));
}

}  // namespace penumbra
