#include "worker/materials/hair_fibre.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "worker/materials/fresnel.h"

namespace penumbra {
namespace {

constexpr int kLobes = 4, kRest = 3;
constexpr double kPi = std::numbers::pi;
constexpr double kLeastRoughness = 1e-3;

/// exp(-x) I₀(x), x >= 0, to 2e-7 of its value: Abramowitz & Stegun 1964, 9.8.1 and 9.8.2.
double scaled_bessel_i0(double x) {
  const auto horner = [](double t, std::initializer_list<double> falling) {
    double sum = 0;
    for (const double c : falling) sum = sum * t + c;
    return sum;
  };
  if (x < 3.75) {
    const double t = x / 3.75;
    return std::exp(-x) *
           horner(t * t, {0.0045813, 0.0360768, 0.2659732, 1.2067492, 3.0899424, 3.5156229, 1});
  }
  return horner(3.75 / x, {0.00392377, -0.01647633, 0.02635537, -0.02057706, 0.00916281, -0.00157565,
                           0.00225319, 0.01328592, 0.39894228}) /
         std::sqrt(x);
}

struct Angles {
  explicit Angles(const Vec3d& w) : sin(w.x), cos(std::hypot(w.y, w.z)), phi(std::atan2(w.z, w.y)) {}
  double sin, cos, phi;
};

double variance_of(const HairFibre& hair, int p) {
  return hair.variance * (p == 0 ? 1 : p == 1 ? 0.25 : 4);
}

/// What wo alone decides.
struct Lobes {
  Lobes(const HairFibre& hair, const Vec3d& wo);
  /// Change of φ by the geometry of p: 2 p γ_t - 2 γ_o + p π.
  double turn(int p) const { return 2 * p * gamma_t - 2 * gamma_o + p * kPi; }

  Angles o;
  double gamma_o, gamma_t;
  std::array<Vec3d, kLobes> attenuation;  ///< A_p
  std::array<double, kLobes> share;       ///< of the samples: A_p's mean over the channels, normalised
  std::array<double, kLobes> sin, cos;    ///< of θ_o, turned by the scales' tilt
};

Lobes::Lobes(const HairFibre& hair, const Vec3d& wo) : o(wo) {
  const double h = hair.h, eta = hair.eta;
  gamma_o = std::asin(h);
  // η² - sin²θ_o as η² - 1 + cos²θ_o, which does not cancel.
  const double bend = std::sqrt((eta - 1) * (eta + 1) + o.cos * o.cos);
  const double sin_gamma_t = h * o.cos / bend;
  gamma_t = std::asin(std::clamp(sin_gamma_t, -1., 1.));
  const double cos_theta_t = bend / eta, cos_gamma_t = std::cos(gamma_t), cos_gamma_o = std::cos(gamma_o);
  const double reflected = fresnel_dielectric(o.cos * cos_gamma_o, 1, eta);
  double total = 0;
  for (int c = 0; c < 3; ++c) {
    const double through = std::exp(-hair.sigma_a[c] * 2 * cos_gamma_t / cos_theta_t);
    attenuation[0][c] = reflected;
    attenuation[1][c] = (1 - reflected) * (1 - reflected) * through;
    attenuation[2][c] = attenuation[1][c] * through * reflected;
    const double again = through * reflected;
    attenuation[kRest][c] = again < 1 ? attenuation[2][c] * again / (1 - again) : 0;
  }
  for (int p = 0; p < kLobes; ++p) {
    share[p] = attenuation[p].x + attenuation[p].y + attenuation[p].z;
    total += share[p];
  }
  for (double& s : share) s /= total;
  // Tilts 2α, -α, -4α of R, TT, TRT; the rest has none.
  const double s1 = hair.sin_tilt, c1 = hair.cos_tilt, s2 = 2 * s1 * c1, c2 = c1 * c1 - s1 * s1;
  const double s4 = 2 * s2 * c2, c4 = c2 * c2 - s2 * s2;
  const double tilt_sin[] = {s2, -s1, -s4, 0}, tilt_cos[] = {c2, c1, c4, 1};
  for (int p = 0; p < kLobes; ++p) {
    sin[p] = o.sin * tilt_cos[p] - o.cos * tilt_sin[p];
    cos[p] = std::abs(o.cos * tilt_cos[p] + o.sin * tilt_sin[p]);
  }
}

/// x - 2π k in [-π,π].
double wrapped(double x) {
  return std::remainder(x, 2 * kPi);
}

/// M_p N_p at wi.
double density(const HairFibre& hair, const Lobes& lobes, const Angles& i, int p) {
  const double m = hair_longitudinal(i.sin, i.cos, lobes.sin[p], lobes.cos[p], variance_of(hair, p));
  if (p == kRest) return m / (2 * kPi);
  return m * hair_azimuthal(wrapped(i.phi - lobes.o.phi - lobes.turn(p)), hair.scale);
}

/// From M, after d'Eon et al. 2013: cosine to the cone's axis by inversion, then around it.
void sample_longitudinal(double sin_o, double cos_o, double v, double u, double around, double& sin_i,
                         double& cos_i) {
  // 1 - cosine = -v ln(u + (1-u) e^{-2/v}), within [0,2]; where the power underflows, u decides alone.
  const double less = std::clamp(-v * std::log(u + (1 - u) * std::exp(-2 / v)), 0., 2.);
  const double sine = std::sqrt(less * (2 - less));
  sin_i = std::clamp(-(1 - less) * sin_o + sine * std::cos(2 * kPi * around) * cos_o, -1., 1.);
  cos_i = std::sqrt((1 - sin_i) * (1 + sin_i));
}

}  // namespace

double hair_longitudinal(double sin_i, double cos_i, double sin_o, double cos_o, double v) {
  // exp(-sin sin'/v) I₀(cos cos'/v) / (2 v sinh(1/v)), all growing factors in one exponent: it is
  // (cos(θ+θ') - 1)/v, at most 0, as half a sum of squares.
  const double a = sin_i + sin_o, b = cos_i - cos_o;
  return std::exp(-0.5 * (a * a + b * b) / v) * scaled_bessel_i0(cos_i * cos_o / v) /
         (v * -std::expm1(-2 / v));
}

double hair_azimuthal(double x, double scale) {
  const double e = std::exp(-std::abs(x) / scale);
  return e / (scale * (1 + e) * (1 + e)) / std::tanh(kPi / (2 * scale));
}

double sample_hair_azimuthal(double u, double scale) {
  // The logistic's distribution function is 1/(1 + e^{-x/s}); on [-π,π] its range has length tanh(π/2s).
  const double range = std::tanh(kPi / (2 * scale)), centred = (u - 0.5) * range;
  return std::clamp(scale * std::log((0.5 + centred) / (0.5 - centred)), -kPi, kPi);
}

HairFibre hair_fibre(const Vec3f& sigma_a, double h, double eta, double beta_m, double beta_n, double tilt) {
  const double m = std::max(beta_m, kLeastRoughness), n = std::max(beta_n, kLeastRoughness);
  HairFibre hair;
  hair.sigma_a = sigma_a;
  hair.h = static_cast<float>(std::clamp(h, -1., 1.));
  hair.eta = static_cast<float>(eta);
  const double deviation = 0.726 * m + 0.812 * m * m + 3.7 * std::pow(m, 20);
  hair.variance = static_cast<float>(deviation * deviation);
  hair.scale = static_cast<float>(std::sqrt(kPi / 8) * (0.265 * n + 1.194 * n * n + 5.372 * std::pow(n, 22)));
  hair.sin_tilt = static_cast<float>(std::sin(tilt * kPi / 180));
  hair.cos_tilt = static_cast<float>(std::cos(tilt * kPi / 180));
  return hair;
}

Rgb f(const HairFibre& hair, const Vec3d& wo, const Vec3d& wi) {
  const Lobes lobes(hair, wo);
  const Angles i(wi);
  Vec3d sum(0);
  for (int p = 0; p < kLobes; ++p) sum += lobes.attenuation[p] * density(hair, lobes, i, p);
  sum /= std::abs(wi.z);
  return {static_cast<float>(sum.x), static_cast<float>(sum.y), static_cast<float>(sum.z)};
}

double pdf(const HairFibre& hair, const Vec3d& wo, const Vec3d& wi) {
  const Lobes lobes(hair, wo);
  const Angles i(wi);
  double sum = 0;
  for (int p = 0; p < kLobes; ++p) sum += lobes.share[p] * density(hair, lobes, i, p);
  return sum;
}

std::optional<Vec3d> sample(const HairFibre& hair, const Vec3d& wo, const Vec2d& u, double choice) {
  const Lobes lobes(hair, wo);
  int p = 0;
  double rest = u.x;
  for (; p < kRest && rest >= lobes.share[p]; ++p) rest -= lobes.share[p];
  if (!(lobes.share[p] > 0)) return std::nullopt;  // u.x at 1 by rounding
  double sin, cos;
  sample_longitudinal(lobes.sin[p], lobes.cos[p], variance_of(hair, p), std::min(rest / lobes.share[p], 1.),
                      choice, sin, cos);
  const double turn = p == kRest ? 2 * kPi * u.y : lobes.turn(p) + sample_hair_azimuthal(u.y, hair.scale);
  const double phi = lobes.o.phi + turn;
  return Vec3d(sin, cos * std::cos(phi), cos * std::sin(phi));
}

Vec3f hair_absorption_of(const Rgb& color, double beta_n) {
  const double b = beta_n;
  const double albedo = 5.969 - 0.215 * b + 2.532 * b * b - 10.73 * std::pow(b, 3) + 5.574 * std::pow(b, 4) +
                        0.245 * std::pow(b, 5);
  Vec3f sigma;
  for (int c = 0; c < 3; ++c) {
    // Black would absorb without bound: the least normal float is as black as a picture can show.
    const double root = std::log(std::clamp<double>(color[c], std::numeric_limits<float>::min(), 1)) / albedo;
    sigma[c] = static_cast<float>(root * root);
  }
  return sigma;
}

Vec3f hair_absorption_of_melanin(double eumelanin, double pheomelanin) {
  return Vec3f(Vec3d(0.419, 0.697, 1.37) * eumelanin + Vec3d(0.187, 0.4, 1.05) * pheomelanin);
}

}  // namespace penumbra
