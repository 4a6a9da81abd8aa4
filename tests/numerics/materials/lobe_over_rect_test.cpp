// Battery f6: a lobe times the cosine over a rectangle, by adaptive quadrature of the product's own
// functions.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "tests/numerics/csv.h"
#include "tests/numerics/worst_errors.h"
#include "worker/materials/microfacet_reflection.h"
#include "worker/materials/phong.h"

namespace penumbra {
namespace {

/// Nodes and weights of n-point Gauss–Legendre quadrature on [0,1], by Newton's method on P_n.
template <int n>
struct GaussLegendre {
  std::array<double, n> x, w;
  GaussLegendre() {
    for (int i = 0; i < n; ++i) {
      double z = std::cos(std::numbers::pi * (i + 0.75) / (n + 0.5)), slope = 0;
      for (int step = 0; step < 100; ++step) {
        double p = 1, before = 0;
        for (int k = 0; k < n; ++k) {
          const double next = ((2 * k + 1) * z * p - k * before) / (k + 1);
          before = p;
          p = next;
        }
        slope = n * (z * p - before) / (z * z - 1);
        const double change = p / slope;
        z -= change;
        if (std::abs(change) < 1e-16) break;
      }
      x[i] = (1 + z) / 2;
      w[i] = 1 / ((1 - z * z) * slope * slope);
    }
  }
};

/// ∫∫ over the unit square, split in four until a 12×12 rule agrees with its four parts; the parts are then
/// better than the difference by many orders. Squares at the peak are split down to 2⁻¹⁴ in any case:
/// a peak between the nodes is not seen.
template <class F>
class Quadrature {
 public:
  Quadrature(F f, const Vec2d& peak) : f_(f), peak_(peak) {}
  double operator()(double tolerance) { return refine(0, 0, 1, rule(0, 0, 1), tolerance, 0); }

 private:
  double rule(double x0, double y0, double size) const {
    double sum = 0;
    for (size_t i = 0; i < gauss_.x.size(); ++i) {
      for (size_t j = 0; j < gauss_.x.size(); ++j) {
        sum += gauss_.w[i] * gauss_.w[j] * f_(x0 + size * gauss_.x[i], y0 + size * gauss_.x[j]);
      }
    }
    return sum * size * size;
  }
  bool near_peak(double x, double y, double size) const {
    return std::abs(peak_.x - (x + size / 2)) <= size && std::abs(peak_.y - (y + size / 2)) <= size;
  }
  double refine(double x, double y, double size, double whole, double tolerance, int depth) {
    const double h = size / 2;
    const std::array<double, 4> parts = {rule(x, y, h), rule(x + h, y, h), rule(x, y + h, h),
                                         rule(x + h, y + h, h)};
    const double sum = parts[0] + parts[1] + parts[2] + parts[3];
    const bool settled = std::abs(sum - whole) <= tolerance && !(depth < 14 && near_peak(x, y, size));
    if (depth >= 3 && (settled || depth == 24)) return sum;
    double total = 0;
    for (int k = 0; k < 4; ++k)
      total += refine(x + h * (k & 1), y + h * (k >> 1), h, parts[k], tolerance, depth + 1);
    return total;
  }
  F f_;
  Vec2d peak_;
  GaussLegendre<12> gauss_;
};

/// Where the mirror direction of wo meets the rectangle's plane, as fractions of the (orthogonal) edges.
Vec2d mirror_point(const Vec3d& wo, const Vec3d& s, const Vec3d& ex, const Vec3d& ey) {
  const Vec3d r(-wo.x, -wo.y, wo.z), n = ex % ey;
  const Vec3d p = r * ((s ^ n) / (r ^ n)) - s;
  return {(p ^ ex) / ex.length2(), (p ^ ey) / ey.length2()};
}

double lobe_value(const numerics::Row& row, const Vec3d& wo, const Vec3d& wi) {
  const double parameter = row.single("param");
  if (row.text("lobe") == "phong") return phong(parameter, wo, wi);
  const Vec3d wh = (wo + wi).normalized();
  return microfacet_reflection_term({parameter, parameter}, wo, wi, wh);
}

/// ∫ f cosθ dω over the rectangle as ∫∫ f z cosθ_l / r² dA, cosθ_l at the light.
double over_rectangle(const numerics::Row& row, double tolerance) {
  const Vec3d wo = Vec3d(row.vector("wo")).normalized();
  const Vec3d s(row.vector("s")), ex(row.vector("ex")), ey(row.vector("ey"));
  const Vec3d area = ex % ey;
  const auto integrand = [&](double u, double v) {
    const Vec3d p = s + ex * u + ey * v;
    const double r2 = p.length2(), r = std::sqrt(r2);
    const Vec3d wi = p / r;
    if (wi.z <= 0) return 0.0;
    return lobe_value(row, wo, wi) * wi.z * std::abs(wi ^ area) / r2;
  };
  return Quadrature(integrand, mirror_point(wo, s, ex, ey))(tolerance);
}

TEST(LobeOverRectangle, QuadratureOfTheProductsOwnFunctionsMeetsTheBattery) {
  numerics::WorstErrors errors("f6_lobe_over_rect");
  constexpr double kAllowed = 1e-9 / numerics::kEpsilon;  // a quadrature's 1e-9, in units of roundoff
  for (const auto& row : numerics::read_battery("f6_lobe_over_rect")) {
    const double expected = row.number("integral");
    const double value = over_rectangle(row, 1e-11 * expected);
    errors.relative(row.text("lobe"), row.label(), value, expected, 0, kAllowed);
    if (row.text("lobe") == "ggx") {
      EXPECT_LE(value, 1 + 1e-12) << row.label() << ": more than all light is reflected";
    }
  }
}

}  // namespace
}  // namespace penumbra
