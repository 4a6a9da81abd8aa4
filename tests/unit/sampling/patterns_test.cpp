#include "worker/sampling/patterns.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <vector>

#include "worker/sampling/hash.h"
#include "worker/sampling/sampler.h"

namespace penumbra {
namespace {

TEST(Philox, KnownAnswers) {
  // Random123, kat_vectors: philox4x32 10.
  const Random4 zero = philox(0, 0, 0);
  EXPECT_EQ(zero.x[0], 0x6627e8d5u);
  EXPECT_EQ(zero.x[1], 0xe169c58du);
  EXPECT_EQ(zero.x[2], 0xbc57ac4cu);
  EXPECT_EQ(zero.x[3], 0x9b00dbd8u);
  const Random4 pi = philox(0x299f31d0a4093822u, 0x85a308d3243f6a88u, 0x0370734413198a2eu);
  EXPECT_EQ(pi.x[0], 0xd16cfe09u);
  EXPECT_EQ(pi.x[1], 0x94fdccebu);
  EXPECT_EQ(pi.x[2], 0x5001e420u);
  EXPECT_EQ(pi.x[3], 0x24126ea1u);
}

TEST(Uniform, NeverReachesOne) {
  EXPECT_EQ(uniform(0), 0.0);
  EXPECT_LT(uniform(~uint64_t{0}), 1.0);
  EXPECT_EQ(uniform(~uint64_t{0}), 1 - 0x1p-53);
}

TEST(Permute, IsABijection) {
  for (const uint32_t size : {1u, 2u, 3u, 4u, 5u, 7u, 8u, 12u, 16u, 17u, 100u, 255u, 256u, 257u, 1000u}) {
    for (uint64_t seed = 0; seed < 20; ++seed) {
      std::set<uint32_t> images;
      for (uint32_t i = 0; i < size; ++i) images.insert(permute(i, size, mix64(seed)));
      EXPECT_EQ(images.size(), size);
      EXPECT_LT(*images.rbegin(), size);
    }
  }
}

TEST(Permute, EveryImageIsUniformOverTheSeeds) {
  constexpr int kSeeds = 20000;
  for (const uint32_t size : {2u, 3u, 5u, 6u, 7u, 12u}) {
    for (const uint32_t i : {0u, size / 2, size - 1}) {
      std::vector<int> hits(size);
      for (uint64_t seed = 0; seed < kSeeds; ++seed) ++hits[permute(i, size, mix64(seed))];
      const double expected = static_cast<double>(kSeeds) / size, sigma = std::sqrt(expected);
      for (const int n : hits) EXPECT_NEAR(n, expected, 5 * sigma) << i << " of " << size;
    }
  }
}

TEST(Permute, PairsOfImagesAreNearlyIndependent) {
  // Neighbours must land on every ordered pair of places about equally often.
  constexpr int kSeeds = 60000, kSize = 6;
  std::vector<int> hits(kSize * kSize);
  for (uint64_t seed = 0; seed < kSeeds; ++seed)
    ++hits[permute(2, kSize, mix64(seed)) * kSize + permute(3, kSize, mix64(seed))];
  const double expected = static_cast<double>(kSeeds) / (kSize * (kSize - 1));
  for (int a = 0; a < kSize; ++a)
    for (int b = 0; b < kSize; ++b)
      if (a != b) {
        EXPECT_NEAR(hits[a * kSize + b], expected, 0.2 * expected) << a << b;
      }
}

/// Number of cells of a columns × rows grid that hold at least one point.
size_t cells_hit(const std::vector<Vec2d>& points, uint64_t columns, uint64_t rows) {
  std::set<uint64_t> cells;
  for (const Vec2d& p : points)
    cells.insert(static_cast<uint64_t>(p.x * columns) * rows + static_cast<uint64_t>(p.y * rows));
  return cells.size();
}

TEST(MultiJitter, OnePointPerRowColumnAndCell) {
  for (const uint32_t side : {1u, 2u, 3u, 4u, 8u, 10u}) {
    for (uint64_t seed = 0; seed < 10; ++seed) {
      std::vector<Vec2d> points;
      for (uint32_t i = 0; i < side * side; ++i) points.push_back(multi_jitter(i, side * side, mix64(seed)));
      EXPECT_EQ(cells_hit(points, side * side, 1), side * side);
      EXPECT_EQ(cells_hit(points, 1, side * side), side * side);
      EXPECT_EQ(cells_hit(points, side, side), side * side);
    }
  }
}

/// Variance of the mean of f(x,y) = xy over `size` points.
double variance_of_product(uint32_t size) {
  constexpr int kRepeats = 400;
  double m2 = 0;
  for (uint64_t r = 0; r < kRepeats; ++r) {
    double sum = 0;
    for (uint32_t i = 0; i < size; ++i) {
      const Vec2d p = multi_jitter(i, size, mix64(r));
      sum += p.x * p.y;
    }
    m2 += (sum / size - 0.25) * (sum / size - 0.25);
  }
  return m2 / kRepeats;
}

TEST(MultiJitter, ErrorsOfCellsAreIndependent) {
  // Of what is smooth and no sum f(x) + g(y): the variance falls with size⁻² (jitter in cells of area
  // 1/size), with size^−1.5 if the errors of a row's or column's cells are alike. The exponent's standard
  // error is 0.036.
  const double exponent =
      std::log(variance_of_product(64) / variance_of_product(1024)) / std::log(64.0 / 1024);
  EXPECT_LT(exponent, -1.85);
}

TEST(MultiJitter, AnySizeHasOnePointPerRow) {
  for (const uint32_t size : {1u, 2u, 3u, 5u, 6u, 7u, 11u, 13u, 50u}) {
    std::vector<Vec2d> points;
    for (uint32_t i = 0; i < size; ++i) points.push_back(multi_jitter(i, size, mix64(size)));
    EXPECT_EQ(cells_hit(points, 1, size), size);
  }
}

TEST(ScrambledSobol, AlignedBlocksAreNets) {
  for (int k = 0; k <= 8; ++k) {
    const uint32_t size = 1u << k;
    for (const uint32_t first : {0u, size, 5 * size}) {
      for (uint64_t seed = 0; seed < 5; ++seed) {
        std::vector<Vec2d> points;
        for (uint32_t i = 0; i < size; ++i) points.push_back(scrambled_sobol(first + i, mix64(seed)));
        for (int columns = 0; columns <= k; ++columns)
          EXPECT_EQ(cells_hit(points, uint64_t{1} << columns, uint64_t{1} << (k - columns)), size);
      }
    }
  }
}

TEST(Patterns, EveryPointIsUniformOverTheSeeds) {
  // 8×8 cells; a single point of a set, whatever the size of the set.
  constexpr int kSeeds = 64000, kCells = 8;
  const auto judge = [&](auto point, const char* name) {
    std::vector<int> hits(kCells * kCells);
    for (uint64_t seed = 0; seed < kSeeds; ++seed) {
      const Vec2d p = point(mix64(seed + 77));
      ASSERT_TRUE(p.x >= 0 && p.x < 1 && p.y >= 0 && p.y < 1);
      ++hits[static_cast<int>(p.x * kCells) * kCells + static_cast<int>(p.y * kCells)];
    }
    double chi2 = 0;
    const double expected = static_cast<double>(kSeeds) / (kCells * kCells);
    for (const int n : hits) chi2 += (n - expected) * (n - expected) / expected;
    EXPECT_LT(chi2, 63 + 5 * std::sqrt(2.0 * 63)) << name;
  };
  for (const uint32_t size : {1u, 2u, 3u, 5u, 7u, 16u, 1000u}) {
    judge([&](uint64_t seed) { return multi_jitter(permute(0, size, seed), size, seed); }, "first");
    judge([&](uint64_t seed) { return multi_jitter(permute(size - 1, size, seed), size, seed); }, "last");
  }
  for (const uint32_t index : {0u, 1u, 2u, 3u, 6u, 100u, 0xffffffffu})
    judge([&](uint64_t seed) { return scrambled_sobol(index, seed); }, "sobol");
}

TEST(Patterns, TheFactorsOfASobolPairAreIndependent) {
  // x of point 0 and y of point 1 over the seeds: uncorrelated.
  constexpr int kSeeds = 100000;
  double sum = 0;
  for (uint64_t seed = 0; seed < kSeeds; ++seed) {
    const uint64_t s = mix64(seed);
    sum += (scrambled_sobol(0, s).x - 0.5) * (scrambled_sobol(1, s).y - 0.5);
  }
  EXPECT_LT(std::abs(sum / kSeeds), 5 * (1.0 / 12) / std::sqrt(kSeeds));
}

}  // namespace
}  // namespace penumbra
