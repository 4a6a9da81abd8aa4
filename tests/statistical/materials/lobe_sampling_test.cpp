// Each lobe alone, in its own frame: samples follow the density, the density integrates to what does not
// fail, and f/pdf estimates the albedo that quadrature of f gives.
#include <gtest/gtest.h>

#include <string>

#include "tests/statistical/materials/chi_square.h"
#include "worker/materials/lobes.h"

namespace penumbra {
namespace {

using statistical::PolarMap;

struct LobeCase {
  std::string name;
  Lobe lobe;
  double spread = 1;  ///< scale of the lobe's angles
};

std::vector<LobeCase> lobe_cases() {
  const Rgb white(1);
  std::vector<LobeCase> cases = {{"Lambert", Lambert{white}},
                                 {"OrenNayar", oren_nayar(white, 30)},
                                 {"LambertTransmission", LambertTransmission{white}},
                                 {"CoatedLambert", coated_lambert(Rgb(0.8f), 1.5)}};
  const std::pair<double, double> alphas[] = {{1e-3, 1e-3}, {0.02, 0.02}, {0.1, 0.1},
                                              {0.1, 0.4},   {0.5, 0.5},   {1, 1}};
  for (const auto& [ax, ay] : alphas) {
    const TrowbridgeReitz d{ax, ay};
    const std::string suffix = "_" + std::to_string(int(ax * 1000)) + "_" + std::to_string(int(ay * 1000));
    const double spread = std::max(ax, ay);
    cases.push_back({"MicrofacetReflection" + suffix, MicrofacetReflection{white, d, FresnelNone{}}, spread});
    cases.push_back({"MicrofacetTransmission" + suffix, MicrofacetTransmission{white, d, 1, 1.5}, spread});
    cases.push_back({"FresnelBlend" + suffix, FresnelBlend{Rgb(0.5f), Rgb(0.1f), d}, spread});
  }
  return cases;
}

/// Wide lobes in cells about the normal, so that the horizon, where their densities jump, is a border of
/// cells; narrow ones in cells about their peak.
Vec3d cells_axis(const Lobe& lobe, const Vec3d& wo, double spread) {
  if (spread >= 0.1) return {0, 0, 1};
  if (const auto* t = std::get_if<MicrofacetTransmission>(&lobe)) {
    const double eta = wo.z > 0 ? t->eta_above / t->eta_below : t->eta_below / t->eta_above;
    const double sin2 = eta * eta * (wo.x * wo.x + wo.y * wo.y);
    if (sin2 < 1) return {-eta * wo.x, -eta * wo.y, std::copysign(std::sqrt(1 - sin2), -wo.z)};
  }
  return {-wo.x, -wo.y, wo.z};
}

class LobeSampling : public testing::TestWithParam<LobeCase> {};

TEST_P(LobeSampling, SamplesFollowTheDensity) {
  const LobeCase& c = GetParam();
  const double angles[] = {0.02, 0.6, 1.2, 1.5, std::numbers::pi - 0.7};
  const int tests = static_cast<int>(std::size(angles) * lobe_cases().size());
  // Šidák: one false alarm in a hundred for all tests of this kind together.
  const double threshold = 1 - std::pow(0.99, 1.0 / tests);
  for (const double theta : angles) {
    const Vec3d wo(std::sin(theta) * std::cos(0.4), std::sin(theta) * std::sin(0.4), std::cos(theta));
    std::visit(
        [&](const auto& lobe) {
          using L = std::decay_t<decltype(lobe)>;
          if constexpr (!L::kSpecular && !kFibre<L>) {
            const PolarMap map(cells_axis(c.lobe, wo, c.spread), c.spread >= 0.1 ? 1 : c.spread);
            const auto result = statistical::chi_square(
                [&](const Vec2d& u, double) { return sample(lobe, wo, u); },
                [&](const Vec3d& wi) { return pdf(lobe, wo, wi); }, map, 100000, 1234);
            EXPECT_GT(result.p_value, threshold) << "theta " << theta << " total " << result.total;
            EXPECT_LE(result.total, 1 + 1e-3) << "theta " << theta;
            EXPECT_NEAR(result.total, 1 - result.failed, 5 * std::sqrt(0.25 / 100000) + 1e-3)
                << "theta " << theta;
          }
        },
        c.lobe);
  }
}

void PrintTo(const LobeCase& c, std::ostream* out) {
  *out << c.name;
}

std::string name_of(const testing::TestParamInfo<LobeCase>& info) {
  return info.param.name;
}

INSTANTIATE_TEST_SUITE_P(All, LobeSampling, testing::ValuesIn(lobe_cases()), name_of);

}  // namespace
}  // namespace penumbra
