// f8: what arrives at x of light along a line through a homogeneous medium, and the same over r². The product
// has no quadrature of its own; it samples the line by the angle at x. An estimator that is f/p at the point
// of number u has ∫ f as its integral over u in [0,1): that integral is taken here by an adaptive rule, so
// that sample, density and transmittance are judged together.
#include <array>
#include <functional>

#include "tests/numerics/csv.h"
#include "tests/numerics/worst_errors.h"
#include "worker/effects/medium.h"

namespace penumbra::numerics {
namespace {

/// Gauss's rule of ten points.
double gauss(const std::function<double(double)>& f, double a, double b) {
  constexpr std::array<double, 5> kX = {0.1488743389816312, 0.4333953941292472, 0.6794095682990244,
                                        0.8650633666889845, 0.9739065285171717};
  constexpr std::array<double, 5> kW = {0.2955242247147529, 0.2692667193099963, 0.2190863625159820,
                                        0.1494513491505806, 0.0666713443086881};
  const double middle = 0.5 * (a + b), half = 0.5 * (b - a);
  double sum = 0;
  for (size_t i = 0; i < kX.size(); ++i) sum += kW[i] * (f(middle - half * kX[i]) + f(middle + half * kX[i]));
  return sum * half;
}

/// Halves until both halves agree with the whole, relative to what is already known of the integral.
double integral(const std::function<double(double)>& f, double a, double b, double known = 0, int depth = 0) {
  const double middle = 0.5 * (a + b), whole = gauss(f, a, b), left = gauss(f, a, middle),
               right = gauss(f, middle, b);
  if (std::abs(left + right - whole) <= 1e-12 * std::max(std::abs(known), std::abs(left + right)) ||
      depth == 60)
    return left + right;
  // What lies nearer to the larger half first: the rest is judged against it.
  const bool left_first = std::abs(left) >= std::abs(right);
  const double first =
      left_first ? integral(f, a, middle, known, depth + 1) : integral(f, middle, b, known, depth + 1);
  known = std::max(std::abs(known), std::abs(first));
  return first +
         (left_first ? integral(f, middle, b, known, depth + 1) : integral(f, a, middle, known, depth + 1));
}

TEST(Battery, F8Transmittance) {
  WorstErrors errors("f8_transmittance");
  // The battery asks for 1e-9, which is this many roundoffs.
  constexpr double kAllowed = 1e-9 / kEpsilon;
  for (const Row& row : read_battery("f8_transmittance")) {
    const Vec3d x(row.vector("x")), a(row.vector("a")), b(row.vector("b"));
    const double length = (b - a).length();
    const MediumRay part{a, (b - a) / length, double(row.single("v0")) * length,
                         double(row.single("v1")) * length};
    Medium medium;
    medium.sigma_t = medium.sigma_s = Vec3d(row.single("sigma_t"));
    const Equiangular by_angle(part, x);
    ASSERT_TRUE(by_angle.possible()) << row.label();
    const auto estimate = [&](double u, bool over_r2) {
      const double t = by_angle.sample(u), r2 = (part.o + part.d * t - x).length2();
      const double f = transmittance(medium, std::sqrt(r2)).x / (over_r2 ? r2 : 1);
      return f / (by_angle.pdf(t) * length);
    };
    errors.relative("int_T", row.label(), integral([&](double u) { return estimate(u, false); }, 0, 1),
                    row.reference("int_T"), 0, kAllowed);
    errors.relative("int_T_over_r2", row.label(), integral([&](double u) { return estimate(u, true); }, 0, 1),
                    row.reference("int_T_over_r2"), 0, kAllowed);
  }
}

}  // namespace
}  // namespace penumbra::numerics
