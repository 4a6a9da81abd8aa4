#include "worker/sampling/sampler.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <vector>

namespace penumbra {
namespace {

constexpr SamplerKind kAll[] = {SamplerKind::kIndependent, SamplerKind::kStratified, SamplerKind::kSobol};

PassSampler make(SamplerKind kind, int64_t pass, int64_t group, uint32_t pixel = 17, uint64_t seed = 3,
                 uint32_t mix = 0, TaskKind stage = TaskKind::kRun) {
  return PassSampler(kind, seed, mix, stage, pixel, pass, group);
}

TEST(PassSampler, IsAFunctionOfItsKey) {
  for (const SamplerKind kind : kAll) {
    EXPECT_EQ(make(kind, 5, 4).light(1, 2, 3, 1, 4), make(kind, 5, 4).light(1, 2, 3, 1, 4));
    const Vec2d base = make(kind, 5, 4).light(1, 2, 3, 1, 4);
    EXPECT_NE(base, make(kind, 6, 4).light(1, 2, 3, 1, 4));
    EXPECT_NE(base, make(kind, 9, 4).light(1, 2, 3, 1, 4));
    EXPECT_NE(base, make(kind, 5, 4, 18).light(1, 2, 3, 1, 4));
    EXPECT_NE(base, make(kind, 5, 4, 17, 4).light(1, 2, 3, 1, 4));
    EXPECT_NE(base, make(kind, 5, 4, 17, 3, 1).light(1, 2, 3, 1, 4));
    EXPECT_NE(base, make(kind, 5, 4, 17, 3, 0, TaskKind::kPilot).light(1, 2, 3, 1, 4));
    EXPECT_NE(base, make(kind, 5, 4).light(0, 2, 3, 1, 4));
    EXPECT_NE(base, make(kind, 5, 4).light(1, 1, 3, 1, 4));
    EXPECT_NE(base, make(kind, 5, 4).light(1, 2, 2, 1, 4));
    EXPECT_NE(base, make(kind, 5, 4).light(1, 2, 3, 2, 4));
    EXPECT_NE(make(kind, 5, 4).select(0, 0), make(kind, 5, 4).select(0, 1));
    EXPECT_NE(make(kind, 5, 4).film(), make(kind, 5, 4).lens(0, 1));
    EXPECT_NE(make(kind, 5, 4).lens(0, 1), make(kind, 5, 4).lens(0, 2));
    EXPECT_EQ(make(kind, 5, 4).branch(0).film(), make(kind, 5, 4).film());
    EXPECT_NE(make(kind, 5, 4).branch(1).film(), make(kind, 5, 4).film());
  }
}

/// Cells of a columns × rows grid with at least one of the n samples of each of `passes` passes.
size_t cells_hit(SamplerKind kind, int64_t first, int64_t passes, int64_t group, int n, int columns,
                 int rows) {
  std::set<int> cells;
  for (int64_t pass = first; pass < first + passes; ++pass) {
    const PassSampler sampler = make(kind, pass, group);
    for (int i = 0; i < n; ++i) {
      const Vec2d u = sampler.light(0, 1, 0, i, n);
      cells.insert(static_cast<int>(u.x * columns) * rows + static_cast<int>(u.y * rows));
    }
  }
  return cells.size();
}

TEST(PassSampler, SamplesOfAGroupAreStratifiedTogether) {
  for (const SamplerKind kind : {SamplerKind::kStratified, SamplerKind::kSobol}) {
    EXPECT_EQ(cells_hit(kind, 0, 4, 4, 4, 4, 4), 16u);
    EXPECT_EQ(cells_hit(kind, 8, 4, 4, 4, 16, 1), 16u);
    EXPECT_EQ(cells_hit(kind, 8, 4, 4, 4, 1, 16), 16u);
    EXPECT_EQ(cells_hit(kind, 0, 16, 16, 1, 4, 4), 16u);
    EXPECT_EQ(cells_hit(kind, 3, 1, 1, 16, 4, 4), 16u);
  }
  EXPECT_LT(cells_hit(SamplerKind::kIndependent, 0, 4, 4, 4, 4, 4), 16u);
}

TEST(PassSampler, SamplesOfOnePassAreStratifiedToo) {
  for (int64_t pass = 0; pass < 8; ++pass) {
    EXPECT_EQ(cells_hit(SamplerKind::kStratified, pass, 1, 8, 6, 1, 6), 6u);
    EXPECT_EQ(cells_hit(SamplerKind::kSobol, pass, 1, 8, 4, 2, 2), 4u);
  }
}

TEST(PassSampler, FilmAndChoiceAreStratifiedOverTheGroup) {
  for (const SamplerKind kind : {SamplerKind::kStratified, SamplerKind::kSobol}) {
    std::set<int> film, choice, select;
    for (int64_t pass = 16; pass < 32; ++pass) {
      const PassSampler sampler = make(kind, pass, 16);
      const Vec2d u = sampler.film();
      film.insert(static_cast<int>(u.x * 4) * 4 + static_cast<int>(u.y * 4));
      choice.insert(static_cast<int>(sampler.choice(0, 0, 0, 0, 1) * 16));
      select.insert(static_cast<int>(sampler.select(0, 0) * 16));
    }
    EXPECT_EQ(film.size(), 16u);
    EXPECT_EQ(choice.size(), 16u);
    EXPECT_EQ(select.size(), 16u);
  }
}

TEST(PassSampler, GroupsAreIndependent) {
  // Means over a group of an integrand, of neighbouring groups: uncorrelated.
  for (const SamplerKind kind : kAll) {
    constexpr int kPairs = 20000, kGroup = 2;
    double sum = 0, square = 0;
    for (int pair = 0; pair < kPairs; ++pair) {
      double mean[2] = {0, 0};
      for (int g = 0; g < 2; ++g)
        for (int pass = 0; pass < kGroup; ++pass) {
          const Vec2d u = make(kind, (2 * pair + g) * kGroup + pass, kGroup).light(0, 0, 0, 0, 1);
          mean[g] += (u.x * u.y - 0.25) / kGroup;
        }
      sum += mean[0] * mean[1];
      square += 0.5 * (mean[0] * mean[0] + mean[1] * mean[1]);
    }
    EXPECT_LT(std::abs(sum / square), 5 / std::sqrt(kPairs));
  }
}

TEST(PassSampler, StratificationLowersTheVariance) {
  // Variance of the mean of 64 samples of a smooth integrand: independent 1/64 of one sample's; stratified
  // and Sobol' far less.
  const auto variance = [](SamplerKind kind) {
    constexpr int kGroups = 400, kPasses = 16, kSamples = 4;
    double sum = 0, square = 0;
    for (int g = 0; g < kGroups; ++g) {
      double mean = 0;
      for (int pass = 0; pass < kPasses; ++pass)
        for (int i = 0; i < kSamples; ++i) {
          const Vec2d u = make(kind, g * kPasses + pass, kPasses).light(0, 0, 0, i, kSamples);
          mean += std::sin(3 * u.x) * std::exp(u.y) / (kPasses * kSamples);
        }
      sum += mean;
      square += mean * mean;
    }
    return square / kGroups - (sum / kGroups) * (sum / kGroups);
  };
  const double independent = variance(SamplerKind::kIndependent);
  EXPECT_LT(variance(SamplerKind::kStratified), independent / 50);
  EXPECT_LT(variance(SamplerKind::kSobol), independent / 50);
}

TEST(PassSampler, IndependentNumbersAreUniformInTwoDimensions) {
  std::vector<int> hits(256);
  constexpr int kPasses = 100000;
  for (int pass = 0; pass < kPasses; ++pass) {
    const Vec2d u = make(SamplerKind::kIndependent, pass, 1).light(0, 0, 0, 0, 1);
    ++hits[static_cast<int>(u.x * 16) * 16 + static_cast<int>(u.y * 16)];
  }
  double chi2 = 0;
  for (const int n : hits) chi2 += (n - kPasses / 256.0) * (n - kPasses / 256.0) / (kPasses / 256.0);
  EXPECT_LT(std::abs(chi2 - 255), 5 * std::sqrt(2.0 * 255));
}

}  // namespace
}  // namespace penumbra
