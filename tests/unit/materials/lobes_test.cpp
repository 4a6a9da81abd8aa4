// What holds for lobes by physics: reciprocity, energy, no value that is not finite.
#include "worker/materials/lobes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "worker/materials/local_frame.h"
#include "worker/sampling/warp.h"

namespace penumbra {
namespace {

constexpr double kAlphas[] = {1e-3, 0.05, 0.3, 1};

std::vector<Lobe> reflection_lobes() {
  std::vector<Lobe> lobes = {Lambert{Rgb(0.7f)}, oren_nayar(Rgb(0.7f), 40), coated_lambert(Rgb(0.9f), 1.5)};
  for (const double alpha : kAlphas) {
    lobes.push_back(MicrofacetReflection{Rgb(1), {alpha, alpha}, FresnelNone{}});
    lobes.push_back(MicrofacetReflection{Rgb(1), {alpha, 2 * alpha}, FresnelDielectric{1, 1.5}});
    lobes.push_back(FresnelBlend{Rgb(0.5f), Rgb(0.2f), {alpha, alpha}});
  }
  return lobes;
}

template <class F>
void each_smooth(const Lobe& lobe, const F& use) {
  std::visit(
      [&](const auto& kind) {
        using L = std::decay_t<decltype(kind)>;
        if constexpr (!L::kSpecular && !kFibre<L>) use(kind);
      },
      lobe);
}

class Directions {
 public:
  Vec3d hemisphere() { return square_to_cosine_hemisphere({uniform_(generator_), uniform_(generator_)}); }
  Vec2d square() { return {uniform_(generator_), uniform_(generator_)}; }

 private:
  std::mt19937_64 generator_{7};
  std::uniform_real_distribution<double> uniform_{0, 1};
};

TEST(Lobes, ReflectionIsReciprocal) {
  Directions draw;
  for (const Lobe& lobe : reflection_lobes()) {
    each_smooth(lobe, [&](const auto& kind) {
      for (int i = 0; i < 200; ++i) {
        const Vec3d wo = draw.hemisphere(), wi = draw.hemisphere();
        const float forth = f(kind, wo, wi).x, back = f(kind, wi, wo).x;
        EXPECT_NEAR(forth, back, 1e-5f * forth) << "lobe " << lobe.index();
      }
    });
  }
}

// Radiance is scaled by 1/η² on entering: f(wo,wi) η_i² = f(wi,wo) η_o² (Walter et al. 2007).
TEST(Lobes, RefractionIsReciprocalUpToTheIndices) {
  Directions draw;
  const MicrofacetTransmission lobe{Rgb(1), {0.4, 0.4}, 1, 1.5};
  for (int i = 0; i < 500; ++i) {
    const Vec3d wo = draw.hemisphere(), wi = -draw.hemisphere();
    const double forth = f(lobe, wo, wi).x, back = f(lobe, wi, wo).x;
    EXPECT_NEAR(forth * 1.5 * 1.5, back, 1e-5 * back);
  }
}

/// ∫ f cosθ dω by the lobe's own samples.
template <class L>
double albedo(const L& lobe, const Vec3d& wo, int samples) {
  Directions draw;
  double sum = 0;
  for (int i = 0; i < samples; ++i) {
    const auto wi = sample(lobe, wo, draw.square());
    if (!wi) continue;
    const double density = pdf(lobe, wo, *wi);
    if (density > 0) sum += f(lobe, wo, *wi).x * std::abs(wi->z) / density;
  }
  return sum / samples;
}

TEST(Lobes, NoReflectionGainsEnergy) {
  for (const Lobe& lobe : reflection_lobes()) {
    each_smooth(lobe, [&](const auto& kind) {
      for (const double theta : {0.0, 0.7, 1.3, 1.55}) {
        const Vec3d wo(std::sin(theta), 0, std::cos(theta));
        EXPECT_LE(albedo(kind, wo, 20000), 1.01) << "lobe " << lobe.index() << " theta " << theta;
      }
    });
  }
}

TEST(Lobes, RoughGlassNeitherGainsNorLosesMuch) {
  for (const double alpha : {0.05, 0.2}) {
    const TrowbridgeReitz d{alpha, alpha};
    const MicrofacetReflection r{Rgb(1), d, FresnelDielectric{1, 1.5}};
    const MicrofacetTransmission t{Rgb(1), d, 1, 1.5};
    const Vec3d wo(0.5, 0, std::sqrt(0.75));
    // Radiance refracted into the denser side carries 1/η² per solid angle: undo it for the energy.
    const double energy = albedo(r, wo, 40000) + albedo(t, wo, 40000) * 1.5 * 1.5;
    EXPECT_LE(energy, 1.005) << alpha;
    EXPECT_GE(energy, 0.97) << alpha;
  }
}

TEST(Lobes, WhiteFurnaceOfLambertIsExact) {
  EXPECT_NEAR(albedo(Lambert{Rgb(1)}, {0, 0, 1}, 1000), 1, 1e-6);
  EXPECT_NEAR(albedo(LambertTransmission{Rgb(1)}, {0, 0, 1}, 1000), 1, 1e-6);
}

// A white base under a clear coat sends back all that the coat lets in: 1 - F(θo).
TEST(Lobes, AWhiteBaseUnderACoatLosesNothing) {
  for (const double theta : {0.0, 0.8, 1.3}) {
    const Vec3d wo(std::sin(theta), 0, std::cos(theta));
    EXPECT_NEAR(albedo(coated_lambert(Rgb(1), 1.5), wo, 200000), 1 - fresnel_dielectric(wo.z, 1, 1.5), 3e-3);
  }
}

TEST(Lobes, TheDistributionCoversItsOwnProjection) {
  // ∫ D cosθ dω = 1, in tan θ = α tan ψ, where the integrand is flat.
  for (const double alpha : kAlphas) {
    double sum = 0;
    constexpr int kSteps = 20000;
    for (int i = 0; i < kSteps; ++i) {
      const double psi = (i + 0.5) / kSteps * std::numbers::pi / 2;
      const double t = alpha * std::tan(psi), c = 1 / std::sqrt(1 + t * t);
      const double slope = alpha / (std::cos(psi) * std::cos(psi)) * c * c;  // dθ/dψ
      sum += distribution({alpha, alpha}, {t * c, 0, c}) * c * (t * c) * slope;
    }
    EXPECT_NEAR(sum * 2 * std::numbers::pi * std::numbers::pi / 2 / kSteps, 1, 1e-6) << alpha;
  }
}

TEST(Lobes, MaskedProjectedAreaIsTheCosine) {
  // ∫ D G1 max(0, wo·wh) dω = cosθ_o: the visible normals' density integrates to one (Heitz 2014, eq. 14).
  const TrowbridgeReitz d{0.4, 0.4};
  const Vec3d wo(std::sin(1.2), 0, std::cos(1.2));
  double sum = 0;
  constexpr int kSteps = 1000;
  for (int i = 0; i < kSteps; ++i) {
    for (int j = 0; j < kSteps; ++j) {
      const double c = (i + 0.5) / kSteps, s = std::sqrt(1 - c * c),
                   phi = 2 * std::numbers::pi * (j + 0.5) / kSteps;
      const Vec3d wh(s * std::cos(phi), s * std::sin(phi), c);
      if ((wo ^ wh) > 0) sum += visible_normal_pdf(d, wo, wh);
    }
  }
  EXPECT_NEAR(sum * 2 * std::numbers::pi / (kSteps * double(kSteps)), 1, 1e-3);
}

TEST(Lobes, NothingIsEverNotFinite) {
  std::vector<Lobe> lobes = reflection_lobes();
  for (const double alpha : kAlphas) lobes.push_back(MicrofacetTransmission{Rgb(1), {alpha, alpha}, 1, 1.5});
  lobes.push_back(MicrofacetTransmission{Rgb(1), {0.1, 0.1}, 1, 1});
  lobes.push_back(LambertTransmission{Rgb(1)});
  // The contract of lobes.h, at its border: cosines of kLeastCosine, pairs that a lobe is asked for.
  const double tiny = kLeastCosine;
  const Vec3d hard[] = {{0, 0, 1},
                        {1, 0, tiny},
                        {-1, 0, tiny},
                        {1, 0, -tiny},
                        {0.6, 0, 0.8},
                        {-0.6, 0, 0.8},
                        {-0.6, 0, -0.8},
                        {0, 1, 2 * tiny},
                        {1e-20, 0, 1},
                        {0, 0, -1},
                        {std::sqrt(0.5), 0, std::sqrt(0.5)}};
  for (const Lobe& lobe : lobes) {
    each_smooth(lobe, [&](const auto& kind) {
      for (const Vec3d& wo : hard) {
        for (const Vec3d& wi : hard) {
          if (same_hemisphere(wo, wi) == kind.kTransmits) continue;
          const Rgb value = f(kind, wo, wi);
          EXPECT_TRUE(std::isfinite(value.x) && value.x >= 0) << lobe.index() << " " << wo << wi;
          const double density = pdf(kind, wo, wi);
          EXPECT_TRUE(std::isfinite(density) && density >= 0) << lobe.index() << " " << wo << wi;
        }
        for (const double u : {0.0, 0.25, 0.5, 1 - 0x1p-53}) {
          for (const double v : {0.0, 0.5, 1 - 0x1p-53}) {
            const auto wi = sample(kind, wo, {u, v});
            if (!wi) continue;
            EXPECT_NEAR(wi->length(), 1, 1e-9) << lobe.index() << " " << wo << " " << u << " " << v;
          }
        }
      }
    });
  }
}

TEST(RoughnessRemapping, IsPbrts) {
  EXPECT_NEAR(alpha_of_roughness_v3(1), 1.62142, 1e-12);
  EXPECT_NEAR(alpha_of_roughness_v3(0.1), 0.46176, 1e-5);
  EXPECT_EQ(alpha_of_roughness_v3(0), alpha_of_roughness_v3(1e-3));
  EXPECT_EQ(alpha_of_roughness_v4(0.25), 0.5);
}

}  // namespace
}  // namespace penumbra
