// Samples of the visible part of a light: where they fall (χ²), and that their density integrates to 1.
#include "worker/lights/visible_region.h"

#include <array>

#include "tests/statistical/lights/statistics.h"

namespace penumbra::statistical {
namespace {

constexpr int kSamples = 40000, kCells = 8, kFine = 60;  // cells along an edge; points along a cell

const QuadShape kQuad{{-1, -1, 0.9f}, {0, 2, -0.1f}, {2.2f, 0, 0.2f}};

struct Lit {
  const char* name;
  Vec3d x, horizon;
  std::vector<std::array<Vec3f, 3>> occluders;
};
const std::vector<Lit> kLit = {{"one triangle",
                                {0, 0, 0},
                                {0, 0, 0},
                                {{{{-0.3f, -0.2f, 0.3f}, {0.3f, -0.1f, 0.4f}, {0.1f, 0.3f, 0.3f}}}}},
                               {"near the light",
                                {0.1, 0.2, 0.6},
                                {0, 0, 0},
                                {{{{0.1f, 0, 0.7f}, {0.4f, 0.3f, 0.7f}, {0, 0.5f, 0.65f}}}}},
                               {"overlapping, with a horizon",
                                {0.2, 0.1, 0},
                                {0.7, 0.1, 0.3},
                                {{{{0.3f, -2, 0.3f}, {0.4f, 2, 0.3f}, {0.6f, 0, 0.3f}}},
                                 {{{0, -0.1f, 0.2f}, {0.9f, 0.2f, 0.3f}, {0.2f, 0.25f, 0.2f}}},
                                 {{{0.5f, 0.1f, 0.5f}, {0.9f, 0.5f, 0.5f}, {0.5f, 0.6f, 0.1f}}}}}};

TEST(VisibleRegionSampling, FallsWhereItsDensitySays) {
  const Vec3d o(kQuad.o), u(kQuad.u), v(kQuad.v), across = u.cross(v);
  for (const Lit& lit : kLit) {
    VisibleRegion region;
    region.reset(kQuad, lit.x, lit.horizon);
    for (const auto& t : lit.occluders) ASSERT_TRUE(region.subtract(t));
    region.finish();
    ASSERT_FALSE(region.whole() || region.empty()) << lit.name;

    // ∫ pdf dω over each cell, by the middles of small ones.
    constexpr int kAll = kCells * kFine;
    std::vector<double> probability(size_t(kCells * kCells));
    double sum = 0;
    for (int i = 0; i < kAll; ++i)
      for (int j = 0; j < kAll; ++j) {
        const Vec3d p = o + u * ((i + 0.5) / kAll) + v * ((j + 0.5) / kAll), d = p - lit.x;
        const double share = region.pdf(p) * -across.dot(d) / (d.length2() * d.length()) / (kAll * kAll);
        probability[size_t(i / kFine * kCells + j / kFine)] += share;
        sum += share;
      }
    EXPECT_NEAR(sum, 1, 2e-3) << lit.name;

    std::vector<int> hits(probability.size());
    for (int i = 0; i < kSamples; ++i) {
      const Vec3d d = region.sample(random_square(9, uint64_t(i))).p - o;
      const auto cell = [](double f) { return std::clamp(int(f * kCells), 0, kCells - 1); };
      const double s = d.cross(v).dot(across) / across.length2(),
                   t = u.cross(d).dot(across) / across.length2();
      ++hits[size_t(cell(s) * kCells + cell(t))];
    }
    EXPECT_LT(chi_square_sigmas(hits, probability), 4.5) << lit.name;
  }
}

}  // namespace
}  // namespace penumbra::statistical
