#include "worker/lights/line_irradiance.h"

#include <algorithm>
#include <cmath>

namespace penumbra {
namespace {

/// The line as x sees it: P(t) = q + t e − x with q its foot, so that |P|² = D² + t²; and n·P = alpha + beta
/// t.
struct FromX {
  double distance, alpha, beta;
};

// With t = D tanφ: ∫ (α + β t) / (D² + t²)² dt = D⁻³ ∫ (α cosφ + β D sinφ) cosφ dφ.

/// The same in closed form, α/2 (Δ + cosΣ sinΔ) + βD/2 sinΣ sinΔ, with Δ, Σ the difference and the sum of φ
/// at the ends, both of which tan of t's products gives without the angles themselves.
double closed(const FromX& f, double t0, double t1, double delta) {
  const double d = f.distance, r = std::hypot(d, t0) * std::hypot(d, t1);
  const double sin_delta = d * (t1 - t0) / r, cos_sum = (d * d - t0 * t1) / r, sin_sum = d * (t0 + t1) / r;
  return 0.5 * (f.alpha * (delta + cos_sum * sin_delta) + f.beta * d * sin_sum * sin_delta);
}

/// The same by Gauss and Legendre's four points: where Δ is small, the closed form's terms cancel.
double quadrature(const FromX& f, double t0, double delta) {
  constexpr double kAt[] = {0.069431844202973712, 0.33000947820757187};
  constexpr double kWeight[] = {0.17392742256872693, 0.32607257743127307};
  const double d = f.distance, r0 = std::hypot(d, t0), cos0 = d / r0, sin0 = t0 / r0;
  const auto term = [&](double share) {
    const double c = std::cos(share * delta), s = std::sin(share * delta);
    const double cos = cos0 * c - sin0 * s, sin = sin0 * c + cos0 * s;
    return (f.alpha * cos + f.beta * d * sin) * cos;
  };
  double sum = 0;
  for (int i = 0; i < 2; ++i) sum += kWeight[i] * (term(kAt[i]) + term(1 - kAt[i]));
  return sum * delta;
}

/// Between two places where n·P has one sign. Quadrature's relative error is of the order of Δ⁸/10⁸, the
/// closed form loses 1/Δ² to 1/Δ³ of its digits.
double between(const FromX& f, double t0, double t1) {
  const double d = f.distance, delta = std::atan2(d * (t1 - t0), d * d + t0 * t1);
  constexpr double kSmall = 0.15;
  const double integral = delta < kSmall ? quadrature(f, t0, delta) : closed(f, t0, t1, delta);
  return std::abs(integral) / (d * d * d);
}

}  // namespace

double line_irradiance(const LightLine& line, const Vec3d& x, const Vec3d& n, double lo, double hi) {
  const Vec3d start = (line.corner - x) + line.from;
  const double height = -start.dot(line.n), length = line.along.length();
  if (!(height > 0) || !(length > 0) || !(lo < hi)) return 0;
  const Vec3d e = line.along / length;
  const double t_start = start.dot(e);
  const Vec3d foot = start - t_start * e;
  const FromX f{foot.length(), n.dot(foot), n.dot(e)};
  const double t0 = t_start + lo * length, t1 = t_start + hi * length;
  const double zero = -f.alpha / f.beta;  // not finite where the line is parallel to the horizon: no crossing
  if (zero > t0 && zero < t1) return height * (between(f, t0, zero) + between(f, zero, t1));
  return height * between(f, t0, t1);
}

}  // namespace penumbra
