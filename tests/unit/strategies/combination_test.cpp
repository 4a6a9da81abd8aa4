#include "worker/strategies/combination.h"

#include <gtest/gtest.h>

#include <array>
#include <limits>

namespace penumbra {
namespace {

constexpr std::array kCounts{2.0, 0.25, 3.0};  // the second light is drawn a quarter of a time
constexpr std::array kDensities{0.5, 8.0, 0.0};
const std::vector<bool> kLines{false, true, false};

double sum_of_weights(Combiner& combiner) {
  double sum = 0;
  for (size_t s = 0; s < kCounts.size(); ++s) sum += combiner.weight({s, 1, 1, 1, kDensities});
  return sum;
}

TEST(Combiner, WeightsOfAPointSumToOne) {
  for (const Combination how :
       {Combination::kBalance, Combination::kFree, Combination::kPower, Combination::kAverage}) {
    Combiner combiner;
    combiner.start(how, kCounts, kLines);
    EXPECT_DOUBLE_EQ(sum_of_weights(combiner), 1) << int(how);
  }
}

TEST(Combiner, SmoothingIsOfTheDensitiesThatAreNotLines) {
  Combiner combiner;
  combiner.start(Combination::kSmooth, kCounts, kLines);
  EXPECT_DOUBLE_EQ(combiner.weight({0, 0.5, 1, 0.5, kDensities}), 0.2);  // 2·0.5·½ against 0.25·8
  EXPECT_DOUBLE_EQ(combiner.weight({1, 8, 1, 0.5, kDensities}), 0.8);
  EXPECT_EQ(combiner.weight({0, 0.5, 1, 0, kDensities}), 0);
  // Nothing but points, all of them smoothed away: the plain weights.
  combiner.start(Combination::kSmooth, kCounts, {false, false, false});
  EXPECT_DOUBLE_EQ(combiner.weight({0, 0.5, 1, 0, kDensities}), 1.0 / 3);
}

TEST(Combiner, CountsNeedNotBeWhole) {
  Combiner combiner;
  combiner.start(Combination::kBalance, kCounts, kLines);
  EXPECT_DOUBLE_EQ(combiner.weight({0, 0.5, 1, 1, kDensities}), 1.0 / 3);
  EXPECT_DOUBLE_EQ(combiner.scale({0, 0.5, 1, 1, kDensities}), 1.0 / 3);  // 1 / (2·0.5 + 0.25·8)
  combiner.start(Combination::kPower, kCounts, kLines);
  EXPECT_DOUBLE_EQ(combiner.weight({1, 8, 1, 1, kDensities}), 0.8);
}

TEST(Combiner, ScaleIsWeightOverCountTimesDensity) {
  for (const Combination how : {Combination::kBalance, Combination::kPower, Combination::kAverage}) {
    Combiner combiner;
    combiner.start(how, kCounts, kLines);
    for (size_t s = 0; s < 2; ++s) {
      const Found found{s, kDensities[s], 1, 1, kDensities};
      EXPECT_DOUBLE_EQ(combiner.scale(found), combiner.weight(found) / (kCounts[s] * kDensities[s]));
    }
  }
  // `/free`: a line that sees half of its chord has twice the density that its weight counts with.
  Combiner combiner;
  combiner.start(Combination::kFree, kCounts, kLines);
  const Found line{1, 16, 0.5, 1, kDensities};
  EXPECT_DOUBLE_EQ(combiner.scale(line), combiner.weight(line) / (kCounts[1] * 16));
}

TEST(Combiner, AnEndlessDensityCountsNothing) {
  constexpr std::array kEndless{std::numeric_limits<double>::infinity(), 1.0, 1.0};
  for (const Combination how : {Combination::kBalance, Combination::kPower, Combination::kAverage}) {
    Combiner combiner;
    combiner.start(how, kCounts, kLines);
    EXPECT_EQ(combiner.scale({0, kEndless[0], 1, 1, kEndless}), 0) << int(how);
  }
}

}  // namespace
}  // namespace penumbra
