// Directions of Henyey & Greenstein's function follow its density, whose integral is 1.
#include "tests/statistical/materials/chi_square.h"
#include "worker/effects/henyey_greenstein.h"

namespace penumbra::statistical {
namespace {

TEST(HenyeyGreenstein, SamplesFollowTheDensity) {
  const Vec3f wo = Vec3f(0.3f, -0.5f, 0.8f).normalized();
  for (const double g : {-0.95, -0.4, 0.0, 1e-9, 0.35, 0.8, 0.99, 0.9999}) {
    const HenyeyGreenstein hg{g};
    // The peak: straight on, or straight back.
    const PolarMap map(Vec3d(g < 0 ? wo : -wo), std::max(0.3 * (1 - std::abs(g)), 1e-4));
    const ChiSquare result =
        chi_square([&](const Vec2d& u, double) { return std::optional<Vec3d>(sample(hg, wo, u)); },
                   [&](const Vec3d& d) { return phase(hg, wo, Vec3f(d)); }, map, 200000, 5);
    // Directions are rounded to single precision: the density of a narrow peak is known to as much of its
    // width.
    EXPECT_NEAR(result.total, 1, std::max(2e-4, 0x1p-22 / (1 - std::abs(g)))) << g;
    EXPECT_GT(result.p_value, 1e-3) << g;
  }
}

TEST(HenyeyGreenstein, MeanCosineIsG) {
  const Vec3f wo(0, 0, 1);
  for (const double g : {-0.7, 0.0, 0.6}) {
    double sum = 0;
    constexpr int kN = 4000;
    for (int i = 0; i < kN; ++i) sum += -sample(HenyeyGreenstein{g}, wo, {(i + 0.5) / kN, 0.25}).z;
    EXPECT_NEAR(sum / kN, g, 1e-5);
  }
}

}  // namespace
}  // namespace penumbra::statistical
