#include "worker/materials/fresnel.h"

#include <gtest/gtest.h>

#include <cmath>
#include <initializer_list>

namespace penumbra {
namespace {

TEST(FresnelDielectric, NormalIncidence) {
  EXPECT_NEAR(fresnel_dielectric(1, 1, 1.5), 0.04, 1e-12);
  EXPECT_NEAR(fresnel_dielectric(1, 1.5, 1), 0.04, 1e-12);
  EXPECT_NEAR(fresnel_dielectric(0.3, 1, 1), 0, 1e-15);
}

TEST(FresnelDielectric, GrazingAndTotalReflection) {
  EXPECT_NEAR(fresnel_dielectric(0, 1, 1.5), 1, 1e-12);
  const double critical = std::sqrt(1 - 1 / (1.5 * 1.5));
  EXPECT_EQ(fresnel_dielectric(critical * 0.999, 1.5, 1), 1);
  EXPECT_LT(fresnel_dielectric(critical * 1.01, 1.5, 1), 1);
  EXPECT_EQ(fresnel_dielectric(-critical * 0.999, 1, 1.5), 1) << "from below the indices change places";
}

TEST(FresnelDielectric, IsTheSameFromBothEndsOfARefractedRay) {
  for (const double cos_i : {0.1, 0.4, 0.8, 1.0}) {
    const double cos_t = std::sqrt(1 - (1 - cos_i * cos_i) / (1.5 * 1.5));
    EXPECT_NEAR(fresnel_dielectric(cos_i, 1, 1.5), fresnel_dielectric(-cos_t, 1, 1.5), 1e-12);
  }
}

TEST(FresnelDielectric, BrewstersAngleHasOnlyHalf) {
  const double cos_b = 1 / std::sqrt(1 + 1.5 * 1.5);
  const double sin_t = std::sqrt(1 - cos_b * cos_b) / 1.5, cos_t = std::sqrt(1 - sin_t * sin_t);
  const double perpendicular = (cos_b - 1.5 * cos_t) / (cos_b + 1.5 * cos_t);
  EXPECT_NEAR(fresnel_dielectric(cos_b, 1, 1.5), perpendicular * perpendicular / 2, 1e-12);
}

TEST(FresnelConductor, WithoutAbsorptionItIsTheDielectric) {
  for (const double cos_i : {0.05, 0.5, 1.0}) {
    EXPECT_NEAR(fresnel_conductor(cos_i, 1.5, 0), fresnel_dielectric(cos_i, 1, 1.5), 1e-12);
  }
}

TEST(FresnelConductor, NormalIncidenceAndLimits) {
  const double eta = 0.2, k = 3.9;
  EXPECT_NEAR(fresnel_conductor(1, eta, k), ((eta - 1) * (eta - 1) + k * k) / ((eta + 1) * (eta + 1) + k * k),
              1e-12);
  EXPECT_NEAR(fresnel_conductor(0, eta, k), 1, 1e-12);
  for (const double bad : {0.0, 1e-30, 1e6}) {
    const double r = fresnel_conductor(0, bad, 0);
    EXPECT_TRUE(r >= 0 && r <= 1) << bad;
  }
}

TEST(FresnelDiffuse, ClosedFormIsTheIntegral) {
  for (const double n : {1.1, 1.5, 2.4}) {
    double sum = 0;
    constexpr int kSteps = 200000;
    for (int i = 0; i < kSteps; ++i) {
      const double c = (i + 0.5) / kSteps;
      sum += 2 * c * fresnel_dielectric(c, 1, n) / kSteps;
    }
    EXPECT_NEAR(fresnel_diffuse_reflectance(n), sum, 1e-6) << n;
  }
}

}  // namespace
}  // namespace penumbra
