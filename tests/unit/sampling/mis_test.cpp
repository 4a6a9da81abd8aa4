#include "worker/sampling/mis.h"

#include <gtest/gtest.h>

#include <array>
#include <limits>

namespace penumbra {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(BalanceWeights, AreProportionalToCountTimesDensity) {
  std::array<double, 3> w;
  balance_weights(std::array{1.0, 2.0, 3.0}, std::array{2.0, 1.0, 0.0}, {}, w);
  EXPECT_DOUBLE_EQ(w[0], 0.5);
  EXPECT_DOUBLE_EQ(w[1], 0.5);
  EXPECT_EQ(w[2], 0);
  EXPECT_DOUBLE_EQ(inverse_sum(std::array{1.0, 2.0, 3.0}, std::array{2.0, 1.0, 0.0}), 0.25);
}

TEST(BalanceWeights, SmoothingScalesTheDensities) {
  std::array<double, 2> w;
  balance_weights(std::array{1.0, 1.0}, std::array{1.0, 1.0}, std::array{0.25, 1.0}, w);
  EXPECT_DOUBLE_EQ(w[0], 0.2);
  EXPECT_DOUBLE_EQ(w[1], 0.8);
}

TEST(BalanceWeights, ASmoothedAwayDensityDoesNotDrownTheOthers) {
  std::array<double, 3> w;
  balance_weights(std::array{1.0, 1.0, 1.0}, std::array{1e300, 1e-300, 3e-300}, std::array{0.0, 1.0, 1.0}, w);
  EXPECT_EQ(w[0], 0);
  EXPECT_DOUBLE_EQ(w[1], 0.25);
  EXPECT_DOUBLE_EQ(w[2], 0.75);
}

TEST(BalanceWeights, SumToOneEvenWhereEverythingIsSmoothedAway) {
  std::array<double, 2> w;
  balance_weights(std::array{1.0, 3.0}, std::array{1.0, 1.0}, std::array{0.0, 0.0}, w);
  EXPECT_DOUBLE_EQ(w[0], 0.25);
  EXPECT_DOUBLE_EQ(w[1], 0.75);
}

TEST(BalanceWeights, InfinitiesShareAndZerosVanish) {
  std::array<double, 3> w;
  balance_weights(std::array{1.0, 3.0, 5.0}, std::array{kInfinity, kInfinity, 1e308}, {}, w);
  EXPECT_DOUBLE_EQ(w[0], 0.25);
  EXPECT_DOUBLE_EQ(w[1], 0.75);
  EXPECT_EQ(w[2], 0);
  power_weights(std::array{1.0, 3.0, 5.0}, std::array{kInfinity, kInfinity, 1e308}, w);
  EXPECT_DOUBLE_EQ(w[0], 0.1);
  EXPECT_DOUBLE_EQ(w[1], 0.9);
  EXPECT_EQ(w[2], 0);
  EXPECT_EQ(inverse_sum(std::array{1.0, 1.0}, std::array{kInfinity, 1.0}), 0);
  balance_weights(std::array{1.0, 1.0, 1.0}, std::array{0.0, 0.0, 0.0}, {}, w);
  EXPECT_EQ(w, (std::array{0.0, 0.0, 0.0}));
  EXPECT_EQ(inverse_sum(std::array{1.0, 1.0}, std::array{0.0, 0.0}), kInfinity);
}

TEST(BalanceWeights, AStrategyWithoutSamplesHasNoWeight) {
  std::array<double, 2> w;
  balance_weights(std::array{0.0, 1.0}, std::array{kInfinity, 1.0}, {}, w);
  EXPECT_EQ(w[0], 0);
  EXPECT_EQ(w[1], 1);
}

}  // namespace
}  // namespace penumbra
