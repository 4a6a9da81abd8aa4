// The hair model: it loses no light, its samples follow their density, and what it has of reciprocity.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/statistical/materials/chi_square.h"
#include "worker/materials/bsdf.h"

namespace penumbra {
namespace {

constexpr double kPi = std::numbers::pi;

struct HairCase {
  double h, beta_m, beta_n, tilt, absorption, eta;
};

const HairCase kCases[] = {{0, 0.3, 0.3, 2, 0, 1.55},      {0.7, 0.3, 0.3, 2, 0.5, 1.55},
                           {-0.95, 0.25, 0.6, 3, 0, 1.55}, {0.3, 0.9, 0.9, 0, 0.2, 1.55},
                           {-0.5, 0.15, 0.2, 5, 1, 1.33},  {1, 0.3, 0.3, 2, 0, 1.55}};

HairFibre fibre(const HairCase& c) {
  return hair_fibre(Vec3f(static_cast<float>(c.absorption)), c.h, c.eta, c.beta_m, c.beta_n, c.tilt);
}

Vec3d direction(double theta, double phi) {
  return {std::sin(theta), std::cos(theta) * std::cos(phi), std::cos(theta) * std::sin(phi)};
}

const Vec3d kViews[] = {direction(0.1, 1.5), direction(0.8, 1.2), direction(-1.3, 2.5), direction(0.4, -2)};

/// ∫ S dω by the midpoint rule, which for periodic φ and a density that vanishes at the poles converges fast.
double scattered(const HairFibre& hair, const Vec3d& wo) {
  constexpr int kTheta = 300, kPhi = 250;
  double sum = 0;
  for (int i = 0; i < kTheta; ++i)
    for (int j = 0; j < kPhi; ++j) {
      const double theta = (i + 0.5) / kTheta * kPi - kPi / 2, phi = (j + 0.5) / kPhi * 2 * kPi;
      const Vec3d wi = direction(theta, phi);
      sum += double{f(hair, wo, wi).x} * std::abs(wi.z) * std::cos(theta);
    }
  return sum * (kPi / kTheta) * (2 * kPi / kPhi);
}

TEST(Hair, AWhiteFurnaceStaysWhite) {
  for (HairCase c : kCases) {
    c.absorption = 0;
    for (const Vec3d& wo : kViews) EXPECT_NEAR(scattered(fibre(c), wo), 1, 2e-4) << c.h << " " << wo;
  }
}

TEST(Hair, AbsorptionTakesLightAndNeverGivesAny) {
  for (HairCase c : kCases)
    for (const Vec3d& wo : kViews) {
      double last = 1 + 2e-4;
      for (const double absorption : {0.05, 0.5, 5.}) {
        c.absorption = absorption;
        const double now = scattered(fibre(c), wo);
        EXPECT_LE(now, last) << c.h;
        last = now + 1e-9;
      }
    }
}

TEST(Hair, SamplesFollowTheDensity) {
  const double threshold = 1 - std::pow(0.99, 1. / (std::size(kCases) * std::size(kViews)));
  for (const HairCase& c : kCases) {
    const HairFibre hair = fibre(c);
    for (const Vec3d& wo : kViews) {
      const auto result =
          statistical::chi_square([&](const Vec2d& u, double choice) { return sample(hair, wo, u, choice); },
                                  [&](const Vec3d& wi) { return pdf(hair, wo, wi); },
                                  statistical::PolarMap({0, 0, 1}, 1), 100000, 77);
      EXPECT_GT(result.p_value, threshold) << c.h << " " << wo << " total " << result.total;
      EXPECT_NEAR(result.total, 1, 2e-3) << c.h << " " << wo;
      EXPECT_EQ(result.failed, 0);
    }
  }
}

// A_p is a function of the viewer's θ alone, and tilted scales tell root from tip: without tilt, and for
// light from the viewer's θ, the two may be exchanged; the hair is then hit on its other side.
TEST(Hair, IsReciprocalWhereTheModelIs) {
  std::mt19937_64 engine(3);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int i = 0; i < 2000; ++i) {
    HairCase c = kCases[i % std::size(kCases)];
    c.tilt = 0;
    const double theta = 1.4 * uniform(engine);
    const Vec3d a = direction(theta, kPi * uniform(engine)),
                b = direction(i % 2 ? theta : -theta, kPi * uniform(engine));
    const double forth = double{f(fibre(c), a, b).x} * std::abs(b.z);
    c.h = -c.h;
    const double back = double{f(fibre(c), b, a).x} * std::abs(a.z);
    EXPECT_NEAR(forth, back, 1e-5 * (forth + 1e-12)) << i;
  }
}

TEST(Hair, LongitudinalIsNormalisedAtEveryRoughness) {
  for (const double v : {3e-7, 1e-5, 1e-3, 0.05, 0.1, 0.4, 5.})
    for (const double o : {0., 0.7, -1.5}) {
      // θ_i about -θ_o, in steps of its own width.
      const double width = std::min(12 * std::sqrt(v), kPi);
      double sum = 0;
      constexpr int kSteps = 4000;
      for (int i = 0; i < kSteps; ++i) {
        const double theta = -o + width * (2 * (i + 0.5) / kSteps - 1);
        if (std::abs(theta) > kPi / 2) continue;
        const double m = hair_longitudinal(std::sin(theta), std::cos(theta), std::sin(o), std::cos(o), v);
        ASSERT_TRUE(std::isfinite(m)) << v;
        sum += m * std::cos(theta) * 2 * width / kSteps;
      }
      EXPECT_NEAR(sum, 1, 2e-3) << "v " << v << " θ " << o;
    }
}

TEST(Hair, AzimuthalInvertsItsDistribution) {
  for (const double s : {2e-4, 0.05, 0.3, 2.})
    for (const double u : {0., 0.01, 0.3, 0.5, 0.99, 1.}) {
      const double x = sample_hair_azimuthal(u, s);
      ASSERT_LE(std::abs(x), kPi);
      if (u == 1) continue;  // everything is below π
      double below = 0;
      constexpr int kSteps = 20000;
      const double from = std::max(-kPi, x - 60 * s);
      for (int i = 0; i < kSteps; ++i)
        below += hair_azimuthal(from + (x - from) * (i + 0.5) / kSteps, s) * (x - from) / kSteps;
      EXPECT_NEAR(below, u, 1e-5) << s;
    }
}

// Whatever the viewer, the offset and the numbers: nothing that is not finite.
TEST(Hair, IsFiniteAtItsEdges) {
  for (const double h : {-1., 0., 1.})
    for (const double beta : {0., 0.05, 1.})
      for (const double eta : {1., 1.55})
        for (const double absorption : {0., 300.}) {
          const HairFibre hair = hair_fibre(Vec3f(static_cast<float>(absorption)), h, eta, beta, beta, 2);
          for (const Vec3d& wo : {Vec3d(1, 0, 1e-12), Vec3d(0, 0, 1), Vec3d(-1, 1e-9, 1e-9)})
            for (const double u : {0., 0.5, 1.})
              for (const double choice : {0., 1.}) {
                const auto wi = sample(hair, wo.normalized(), {u, u}, choice);
                if (!wi) continue;
                EXPECT_TRUE(std::isfinite(wi->length2()));
                EXPECT_TRUE(std::isfinite(pdf(hair, wo.normalized(), *wi))) << h << beta << eta;
                EXPECT_TRUE(std::isfinite(f(hair, wo.normalized(), *wi).x * wi->z)) << h << beta << eta;
              }
        }
}

TEST(Hair, HasNoHorizonAndNoCosine) {
  SurfacePoint point;
  point.dpdu = Vec3f(1, 0, 0);
  point.dpdv = Vec3f(0, 1, 0);
  const HairFibre hair = fibre(kCases[1]);
  const Vec3f wo = Vec3f(0.3f, 0.2f, 0.9f).normalized();
  std::optional<Rgb> scattered_before;
  const Vec3f wi = Vec3f(0.1f, 0.7f, -0.4f).normalized();
  for (const float turn : {0.f, 0.4f, -0.5f}) {  // of the normal, about the hair
    const Vec3f normal(0, std::sin(turn), std::cos(turn));
    point.ng = point.ns = normal;
    Bsdf bsdf(point, normal);
    bsdf.add(hair);
    EXPECT_TRUE(bsdf.transmits());
    EXPECT_GT(bsdf.pdf(wo, wi), 0);
    const Rgb now = bsdf.scatter(wo, wi);
    EXPECT_GT(now.x, 0);
    if (scattered_before) {
      EXPECT_NEAR(now.x, scattered_before->x, 1e-5 * now.x);
    }
    scattered_before = now;
  }
}

}  // namespace
}  // namespace penumbra
