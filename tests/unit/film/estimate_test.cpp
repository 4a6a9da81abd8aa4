#include "film/estimate.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <vector>

namespace penumbra {
namespace {

TEST(DegreesBehind, KnowsNormalNumbersAndOutliers) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  std::vector<double> values(20000);
  for (double& v : values) v = normal(random);
  EXPECT_NEAR(degrees_behind(values) / 20000, 1, 0.05);
  std::vector<double> one(1000, 0);
  one[17] = 5;
  EXPECT_NEAR(degrees_behind(one), 2, 0.01) << "one deviation is worth nearly nothing";
  EXPECT_TRUE(std::isinf(degrees_behind(std::vector<double>{0.1, -0.1, 0.1})));
  EXPECT_TRUE(std::isinf(degrees_behind(std::vector<double>{0, 0})));
  for (double& v : values) v *= 1e-200;
  EXPECT_NEAR(degrees_behind(values) / 20000, 1, 0.05) << "fourth powers do not vanish";
}

TEST(Interval, IsStudentsAndExact) {
  const ConfidenceInterval t = interval({1, 0.5, 4}, 0.95);
  EXPECT_NEAR(t.low, 1 - 0.5 * 2.776445, 1e-6);
  EXPECT_NEAR(t.high, 1 + 0.5 * 2.776445, 1e-6);
  const ConfidenceInterval z = interval({0, 1, INFINITY}, 0.95);
  EXPECT_NEAR(z.high, 1.959964, 1e-6);
  EXPECT_EQ(interval({2, 0, 1}, 0.95), (ConfidenceInterval{2, 2}));
  EXPECT_NEAR(exp_interval({0, 1, INFINITY}, 0.95).low, std::exp(-1.959964), 1e-6);
}

TEST(Sum, AddsVariancesByWelchAndSatterthwaite) {
  const Estimate s = sum({1, 3, 5}, {2, 4, 10});
  EXPECT_EQ(s.value, 3);
  EXPECT_DOUBLE_EQ(s.standard_error, 5);
  EXPECT_NEAR(s.degrees_of_freedom, 625 / (81. / 5 + 256. / 10), 1e-9);
  EXPECT_TRUE(std::isinf(sum({0, 0, INFINITY}, {0, 0, INFINITY}).degrees_of_freedom));
  EXPECT_DOUBLE_EQ(sum({0, 0, INFINITY}, {0, 2, 7}).degrees_of_freedom, 7);
}

/// Variances with heavy tails: log-normal parts, each seen twice with noise, and now and then one part as
/// large as a tenth of the rest.
TEST(TypicalLogRatio, FindsACommonFactorAmongOutliersAndSaysHowSureItIs) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  constexpr int kTrials = 400, kParts = 500;
  constexpr double kFactor = 1.2;
  double sum = 0, squares = 0;
  int within = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    std::vector<double> a, b;
    for (int i = 0; i < kParts; ++i) {
      const double hard = std::exp(1.5 * normal(random));
      a.push_back(kFactor * hard * std::exp(0.3 * normal(random)));
      b.push_back(hard * std::exp(0.3 * normal(random)));
    }
    (trial % 2 == 0 ? a : b)[static_cast<size_t>(trial % kParts)] += 150;
    const auto ratio = typical_log_ratio(a, b);
    ASSERT_TRUE(ratio.has_value());
    const ConfidenceInterval ci = interval(*ratio, 0.95);
    within += ci.low < std::log(kFactor) && std::log(kFactor) < ci.high;
    sum += ratio->value - std::log(kFactor);
    squares += ratio->standard_error * ratio->standard_error;
  }
  EXPECT_NEAR(sum / kTrials, 0, 0.004);
  EXPECT_LT(std::sqrt(squares / kTrials), 0.035);
  EXPECT_GT(within, 0.92 * kTrials);
  EXPECT_LT(within, 0.98 * kTrials);
}

TEST(TypicalLogRatio, EqualListsAreEqualAndFewPartsTellNothing) {
  const std::vector<double> parts{1, 100, 3, 0.1, 40, 0, 2, 5, 7};
  EXPECT_NEAR(typical_log_ratio(parts, parts)->value, 0, 1e-12);
  EXPECT_NEAR(typical_log_ratio(parts, parts)->standard_error, 0, 1e-12);
  EXPECT_FALSE(typical_log_ratio(std::vector<double>(7, 1.0), std::vector<double>(7, 1.0)).has_value());
}

TEST(PairedLogRatio, WhatIsCommonToBothCancels) {
  std::vector<double> hard = {1, 100, 3, 0.1, 40};
  EXPECT_EQ(paired_log_ratio(hard, hard)->standard_error, 0);
  EXPECT_EQ(paired_log_ratio(hard, hard)->value, 0);
  std::vector<double> twice = hard;
  for (double& v : twice) v *= 2;
  const auto ratio = paired_log_ratio(twice, hard);
  EXPECT_NEAR(ratio->value, std::log(2), 1e-12);
  EXPECT_NEAR(ratio->standard_error, 0, 1e-12);
  const std::vector<double> third{1, 2, 3, 4, 5};
  const auto product = paired_log_product(std::array{Factor{twice, 2}, Factor{hard, -1}, Factor{third, 0.5}});
  ASSERT_TRUE(product.has_value());
  double sums[3] = {0, 0, 0};
  for (size_t i = 0; i < hard.size(); ++i) sums[0] += twice[i], sums[1] += hard[i];
  for (const double v : third) sums[2] += v;
  EXPECT_NEAR(product->value, std::log(sums[0] * sums[0] / sums[1] * std::sqrt(sums[2])), 1e-12);
  EXPECT_FALSE(paired_log_ratio(std::vector<double>{1}, std::vector<double>{1}).has_value());
  EXPECT_FALSE(paired_log_ratio(std::vector<double>{1, -1}, std::vector<double>{1, 1}).has_value());
}

TEST(PairedLogRatio, ItsStandardErrorIsThatOfRepetitions) {
  std::mt19937 random(2);
  std::vector<double> means(300);
  for (double& m : means) m = std::exp(std::normal_distribution<double>()(random));
  double squares = 0, predicted = 0;
  constexpr int kTrials = 1000;
  for (int t = 0; t < kTrials; ++t) {
    std::vector<double> a, b;
    for (const double m : means) {
      a.push_back(m * std::gamma_distribution<double>(20, 0.05)(random));
      b.push_back(m * std::gamma_distribution<double>(20, 0.05)(random));
    }
    const auto ratio = paired_log_ratio(a, b);
    squares += ratio->value * ratio->value / kTrials;
    predicted += ratio->standard_error * ratio->standard_error / kTrials;
  }
  EXPECT_NEAR(predicted / squares, 1, 0.1);
}

TEST(MeanOf, HasItsStandardError) {
  const auto mean = mean_of(std::vector<double>{1, 2, 3, 4});
  EXPECT_EQ(mean->value, 2.5);
  EXPECT_NEAR(mean->standard_error, std::sqrt(5. / 3 / 4), 1e-12);
  EXPECT_EQ(mean->degrees_of_freedom, 3);
  EXPECT_FALSE(mean_of(std::vector<double>{1}).has_value());
}

}  // namespace
}  // namespace penumbra
