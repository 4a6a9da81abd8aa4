#include "worker/materials/fresnel.h"

#include <algorithm>
#include <cmath>

namespace penumbra {

double fresnel_dielectric(double cos_i, double eta_i, double eta_t) {
  if (cos_i < 0) {
    std::swap(eta_i, eta_t);
    cos_i = -cos_i;
  }
  cos_i = std::min(cos_i, 1.0);  // directions are unit to rounding only
  const double eta = eta_i / eta_t;
  const double sin2_t = eta * eta * (1 - cos_i) * (1 + cos_i);
  if (sin2_t >= 1) return 1;
  const double cos_t = std::sqrt(1 - sin2_t);
  const double parallel = (eta_t * cos_i - eta_i * cos_t) / (eta_t * cos_i + eta_i * cos_t);
  const double perpendicular = (eta_i * cos_i - eta_t * cos_t) / (eta_i * cos_i + eta_t * cos_t);
  return (parallel * parallel + perpendicular * perpendicular) / 2;
}

// With (a + ib)² = η² - k² - sin²θ + 2iηk:  R⊥ = (a²+b² - 2a cosθ + cos²θ) / (… + …) and
// R∥ = R⊥ (cos²θ(a²+b²) - 2a cosθ sin²θ + sin⁴θ) / (… + …). Born & Wolf §13.2.
double fresnel_conductor(double cos_i, double eta, double k) {
  const double c = std::min(std::abs(cos_i), 1.0);
  const double c2 = c * c, s2 = 1 - c2;
  const double t0 = eta * eta - k * k - s2;
  const double a2_plus_b2 = std::sqrt(t0 * t0 + 4 * eta * eta * k * k);
  const double a = std::sqrt(std::max(0.0, (a2_plus_b2 + t0) / 2));
  const double t1 = a2_plus_b2 + c2, t2 = 2 * c * a;
  if (t1 + t2 == 0) return 1;  // grazing at an index of sin θ: the limit
  const double perpendicular = (t1 - t2) / (t1 + t2);
  const double t3 = c2 * a2_plus_b2 + s2 * s2, t4 = t2 * s2;
  const double parallel = t3 + t4 > 0 ? perpendicular * (t3 - t4) / (t3 + t4) : perpendicular;
  return (perpendicular + parallel) / 2;
}

double fresnel_diffuse_reflectance(double n) {
  const double n2 = n * n, n4 = n2 * n2;
  return 0.5 + (n - 1) * (3 * n + 1) / (6 * (n + 1) * (n + 1)) +
         n2 * (n2 - 1) * (n2 - 1) / ((n2 + 1) * (n2 + 1) * (n2 + 1)) * std::log((n - 1) / (n + 1)) -
         2 * n * n2 * (n2 + 2 * n - 1) / ((n2 + 1) * (n4 - 1)) +
         8 * n4 * (n4 + 1) / ((n2 + 1) * (n4 - 1) * (n4 - 1)) * std::log(n);
}

namespace {

Rgb reflectance_of(const FresnelNone&, double) {
  return Rgb(1);
}

Rgb reflectance_of(const FresnelDielectric& d, double cos_i) {
  return Rgb(static_cast<float>(fresnel_dielectric(cos_i, d.eta_i, d.eta_t)));
}

Rgb reflectance_of(const FresnelConductor& c, double cos_i) {
  Rgb r;
  for (int i = 0; i < 3; ++i) r[i] = static_cast<float>(fresnel_conductor(cos_i, c.eta[i], c.k[i]));
  return r;
}

}  // namespace

Rgb reflectance(const Fresnel& fresnel, double cos_i) {
  return std::visit([&](const auto& kind) { return reflectance_of(kind, cos_i); }, fresnel);
}

}  // namespace penumbra
