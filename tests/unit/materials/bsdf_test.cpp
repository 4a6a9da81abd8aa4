#include "worker/materials/bsdf.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace penumbra {
namespace {

const Vec3f kUp(0, 0, 1);

SurfacePoint flat_point() {
  SurfacePoint point;
  point.ng = point.ns = kUp;
  point.dpdu = Vec3f(2, 0, 0);
  point.dpdv = Vec3f(0, 3, 0);
  return point;
}

Vec3f in_xz(float degrees) {
  const float a = degrees * std::numbers::pi_v<float> / 180;
  return {std::sin(a), 0, std::cos(a)};
}

// The geometric normal decides what is above: light from below the surface never arrives, light from above
// it does, whatever the shading normal says (pbrt-v3 §9.1).
TEST(Bsdf, GeometricNormalDecides) {
  Bsdf bsdf(flat_point(), in_xz(40));
  bsdf.add(Lambert{Rgb(1)});
  const Vec3f wo = in_xz(20);
  const Vec3f above_shading_only = in_xz(110), above_geometry_only = in_xz(-70);
  EXPECT_EQ(bsdf.f(wo, above_shading_only), Rgb(0));
  EXPECT_EQ(bsdf.pdf(wo, above_shading_only), 0);
  EXPECT_GT(bsdf.f(wo, above_geometry_only).x, 0);
  EXPECT_GT(bsdf.pdf(wo, above_geometry_only), 0);
}

TEST(Bsdf, TransmissionOnlyThroughTheGeometricSurface) {
  Bsdf bsdf(flat_point(), kUp);
  bsdf.add(LambertTransmission{Rgb(0.5f)});
  EXPECT_TRUE(bsdf.transmits());
  EXPECT_EQ(bsdf.f(in_xz(10), in_xz(30)), Rgb(0));
  EXPECT_FLOAT_EQ(bsdf.f(in_xz(10), in_xz(150)).x, 0.5f / std::numbers::pi_v<float>);
}

TEST(Bsdf, AnisotropyFollowsTheTangent) {
  SurfacePoint point = flat_point();
  const MicrofacetReflection brushed{Rgb(1), {0.05, 0.5}, FresnelNone{}};
  Bsdf along_x(point, kUp);
  along_x.add(brushed);
  point.dpdu = Vec3f(0, 5, 0);
  Bsdf along_y(point, kUp);
  along_y.add(brushed);
  const Vec3f a = in_xz(20), b(0, std::sin(0.349066f), std::cos(0.349066f));
  EXPECT_NEAR(along_x.f(kUp, b).x, along_y.f(kUp, a).x, 1e-4);
  EXPECT_GT(along_x.f(kUp, b).x, 2 * along_x.f(kUp, a).x) << "wide across the brushing";
}

TEST(Bsdf, ATangentAlongTheNormalOrUndefinedStillGivesAFrame) {
  for (const Vec3f& dpdu : {Vec3f(0), kUp * 7, Vec3f(std::nanf("")), Vec3f(0, 1e-9f, 1)}) {
    SurfacePoint point = flat_point();
    point.dpdu = dpdu;
    Bsdf bsdf(point, kUp);
    bsdf.add(MicrofacetReflection{Rgb(1), {0.3, 0.3}, FresnelNone{}});
    const auto sample = bsdf.sample(in_xz(30), {0.3, 0.6}, 0);
    ASSERT_TRUE(sample);
    EXPECT_NEAR(sample->wi.length(), 1, 1e-6);
    EXPECT_TRUE(std::isfinite(sample->f.x) && sample->pdf > 0);
  }
}

TEST(Bsdf, SpecularLobesOneByOne) {
  Bsdf bsdf(flat_point(), kUp);
  bsdf.add(Lambert{Rgb(0.5f)});
  bsdf.add(SpecularReflection{Rgb(1), FresnelDielectric{1, 1.5}});
  bsdf.add(SpecularTransmission{Rgb(1), 1, 1.5});
  EXPECT_EQ(bsdf.specular_count(), 2);
  EXPECT_TRUE(bsdf.has_non_specular());
  EXPECT_FALSE(bsdf.transmits()) << "a smooth pane sends no light of a lamp through to sampling";
  const Vec3f wo = in_xz(30);
  const auto reflection = bsdf.sample_specular(wo, 0), refraction = bsdf.sample_specular(wo, 1);
  ASSERT_TRUE(reflection && refraction);
  EXPECT_TRUE(reflection->specular && refraction->specular);
  EXPECT_NEAR((reflection->wi - in_xz(-30)).length(), 0, 1e-6);
  const float sin_t = 0.5f / 1.5f;
  EXPECT_NEAR((refraction->wi - Vec3f(-sin_t, 0, -std::sqrt(1 - sin_t * sin_t))).length(), 0, 1e-6);
  const double fresnel = fresnel_dielectric(std::cos(std::numbers::pi / 6), 1, 1.5);
  EXPECT_NEAR(reflection->f.x * std::abs(reflection->wi.z) / reflection->pdf, fresnel, 1e-6);
  EXPECT_NEAR(refraction->f.x * std::abs(refraction->wi.z) / refraction->pdf, (1 - fresnel) / 2.25, 1e-6);
}

TEST(Bsdf, TotalInternalReflectionHasNoRefraction) {
  Bsdf bsdf(flat_point(), kUp);
  bsdf.add(SpecularTransmission{Rgb(1), 1, 1.5});
  EXPECT_FALSE(bsdf.sample_specular(-in_xz(60), 0));
  EXPECT_TRUE(bsdf.sample_specular(-in_xz(30), 0));
}

TEST(Bsdf, EqualIndicesGoStraightOn) {
  Bsdf bsdf(flat_point(), kUp);
  bsdf.add(SpecularTransmission{Rgb(0.25f), 1, 1});
  const auto sample = bsdf.sample_specular(in_xz(50), 0);
  ASSERT_TRUE(sample);
  EXPECT_NEAR((sample->wi + in_xz(50)).length(), 0, 1e-6);
  EXPECT_NEAR(sample->f.x * std::abs(sample->wi.z), 0.25, 1e-6);
}

TEST(Bsdf, KnowsWhetherALobeIsNarrow) {
  Bsdf bsdf(flat_point(), kUp);
  bsdf.add(Lambert{Rgb(0.5f)});
  bsdf.add(oren_nayar(Rgb(0.5f), 20));
  bsdf.add(SpecularReflection{Rgb(1), FresnelDielectric{1, 1.5}});
  EXPECT_FALSE(bsdf.has_narrow_lobe()) << "a mirror takes no light samples";
  bsdf.add(MicrofacetReflection{Rgb(1), {0.16, 0.16}, FresnelDielectric{1, 1.5}});
  EXPECT_FALSE(bsdf.has_narrow_lobe()) << "its peak is 9.8 times a Lambertian surface's";
  bsdf.add(MicrofacetReflection{Rgb(1), {0.05, 0.05}, FresnelDielectric{1, 1.5}}, Rgb(0));
  EXPECT_FALSE(bsdf.has_narrow_lobe()) << "a black lobe is none";
  bsdf.add(MicrofacetReflection{Rgb(1), {0.15, 0.15}, FresnelDielectric{1, 1.5}});
  EXPECT_TRUE(bsdf.has_narrow_lobe());
}

TEST(Bsdf, ScaleMultipliesAndBlackAddsNothing) {
  Bsdf bsdf(flat_point(), kUp);
  bsdf.add(Lambert{Rgb(1)}, Rgb(0));
  EXPECT_FALSE(bsdf.has_non_specular());
  EXPECT_FALSE(bsdf.sample(kUp, {0.5, 0.5}, 0.5));
  bsdf.add(Lambert{Rgb(1)}, Rgb(0.25f));
  EXPECT_FLOAT_EQ(bsdf.f(kUp, in_xz(20)).x, 0.25f / std::numbers::pi_v<float>);
  EXPECT_NEAR(bsdf.pdf(kUp, kUp), std::numbers::inv_pi, 1e-7) << "the density has no colour";
}

TEST(Bsdf, SurfacesSeenEdgeOnAreBlack) {
  Bsdf bsdf(flat_point(), kUp);
  bsdf.add(Lambert{Rgb(1)});
  const Vec3f edge(1, 0, 0);
  EXPECT_EQ(bsdf.f(edge, kUp), Rgb(0));
  EXPECT_FALSE(bsdf.sample(edge, {0.5, 0.5}, 0.5));
  EXPECT_EQ(bsdf.f(kUp, edge), Rgb(0));
}

TEST(BsdfDeathTest, NinthLobe) {
  Bsdf bsdf(flat_point(), kUp);
  for (int i = 0; i < Bsdf::kMostLobes; ++i) bsdf.add(Lambert{Rgb(0.1f)});
  EXPECT_DEATH(bsdf.add(Lambert{Rgb(0.1f)}), "check failed");
}

}  // namespace
}  // namespace penumbra
