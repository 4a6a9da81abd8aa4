// The mixture of lobes in world space, with a shading normal away from the geometric one.
#include <gtest/gtest.h>

#include "tests/statistical/materials/chi_square.h"
#include "worker/materials/bsdf.h"

namespace penumbra {
namespace {

using statistical::PolarMap;

SurfacePoint flat_point() {
  SurfacePoint point;
  point.ng = point.ns = Vec3f(0, 0, 1);
  point.dpdu = Vec3f(1, 0, 0);
  point.dpdv = Vec3f(0, 1, 0);
  return point;
}

Vec3f tilted(float angle) {
  return {std::sin(angle), 0, std::cos(angle)};
}

struct Surface {
  const char* name;
  float tilt;  ///< of the shading normal
  Vec3f wo;
};

const Surface kSurfaces[] = {
    {"flat", 0, Vec3f(0.3f, 0.2f, 0.933f)},
    {"tilted towards the viewer", 0.5f, Vec3f(0.9f, 0.1f, 0.424f)},
    {"tilted away", 0.5f, Vec3f(-0.6f, 0.1f, 0.79f)},
    {"seen from behind", 0.3f, Vec3f(0.2f, 0.5f, -0.84f)},
    {"in front of one normal, behind the other", 0.8f, Vec3f(-0.9f, 0, 0.436f)},
};

Bsdf plastic(const Surface& s) {
  Bsdf bsdf(flat_point(), tilted(s.tilt));
  bsdf.add(Lambert{Rgb(0.5f)});
  bsdf.add(MicrofacetReflection{Rgb(0.5f), {0.2, 0.2}, FresnelDielectric{1, 1.5}});
  return bsdf;
}

Bsdf translucent(const Surface& s) {
  Bsdf bsdf(flat_point(), tilted(s.tilt));
  bsdf.add(Lambert{Rgb(0.2f)}, Rgb(0.3f));
  bsdf.add(LambertTransmission{Rgb(0.6f)});
  bsdf.add(MicrofacetReflection{Rgb(0.5f), {0.3, 0.3}, FresnelNone{}}, Rgb(0.7f));
  bsdf.add(MicrofacetTransmission{Rgb(0.5f), {0.3, 0.3}, 1, 1.5});
  bsdf.add(SpecularReflection{Rgb(1), FresnelNone{}});
  return bsdf;
}

void expect_samples_follow_pdf(const Bsdf& bsdf, const Surface& surface) {
  const Vec3f wo = surface.wo.normalized();
  const auto sample = [&](const Vec2d& u, double choice) -> std::optional<Vec3d> {
    const auto s = bsdf.sample(wo, u, choice);
    if (!s) return std::nullopt;
    EXPECT_FALSE(s->specular);
    EXPECT_EQ(s->pdf, bsdf.pdf(wo, s->wi));
    EXPECT_EQ(s->f, bsdf.f(wo, s->wi));
    return Vec3d(s->wi);
  };
  const auto density = [&](const Vec3d& wi) { return bsdf.pdf(wo, Vec3f(wi)); };
  const auto result = statistical::chi_square(sample, density, PolarMap({0, 0, 1}, 1), 100000, 99);
  EXPECT_GT(result.p_value, 1e-3) << surface.name << " total " << result.total << " failed " << result.failed;
  EXPECT_LE(result.total, 1 + 1e-3) << surface.name;
}

TEST(BsdfSampling, PlasticFollowsItsDensity) {
  for (const Surface& s : kSurfaces) expect_samples_follow_pdf(plastic(s), s);
}

TEST(BsdfSampling, TranslucentFollowsItsDensity) {
  for (const Surface& s : kSurfaces) expect_samples_follow_pdf(translucent(s), s);
}

// Wherever f is not zero samples arrive: sampling by the BSDF gives the same integral as sampling the
// sphere, also where the two normals disagree about what is above the surface.
TEST(BsdfSampling, EstimatesTheSameIntegralAsUniformSampling) {
  for (const Surface& s : kSurfaces) {
    const Bsdf bsdf = translucent(s);
    const Vec3f wo = s.wo.normalized();
    std::mt19937_64 generator(5);
    std::uniform_real_distribution<double> uniform(0, 1);
    constexpr int kSamples = 400000;
    double own = 0, own2 = 0, other = 0, other2 = 0;
    for (int i = 0; i < kSamples; ++i) {
      const double x = uniform(generator), y = uniform(generator), z = uniform(generator);
      if (const auto sampled = bsdf.sample(wo, {x, y}, z)) {
        const double v = sampled->f.x * std::abs(sampled->wi ^ bsdf.ns()) / sampled->pdf;
        own += v;
        own2 += v * v;
      }
      const Vec3f wi(square_to_sphere({x, y}));
      const double v = bsdf.f(wo, wi).x * std::abs(wi ^ bsdf.ns()) * 4 * std::numbers::pi;
      other += v;
      other2 += v * v;
    }
    const double mean = own / kSamples, reference = other / kSamples;
    const double variance =
        (own2 / kSamples - mean * mean + other2 / kSamples - reference * reference) / kSamples;
    EXPECT_NEAR(mean, reference, 4 * std::sqrt(variance)) << s.name;
  }
}

}  // namespace
}  // namespace penumbra
