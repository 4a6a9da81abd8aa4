#include "film/moments.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace penumbra {
namespace {

struct Group {
  double mean, weight;
};

std::vector<Group> random_groups(int n, unsigned seed, double offset = 0) {
  std::mt19937_64 random(seed);
  std::lognormal_distribution<double> value;
  std::uniform_int_distribution<int> passes(1, 9);
  std::vector<Group> groups;
  for (int i = 0; i < n; ++i) groups.push_back({offset + value(random), static_cast<double>(passes(random))});
  return groups;
}

Moments accumulate(const std::vector<Group>& groups, size_t begin, size_t end) {
  Moments m;
  for (size_t i = begin; i < end; ++i) m.add(groups[i].mean, groups[i].weight);
  return m;
}

/// By another road: two passes in long double.
void expect_is_whole(const Moments& m, const std::vector<Group>& groups) {
  long double weight = 0, sum = 0, m2 = 0, largest = 0;
  for (const Group& g : groups) {
    weight += g.weight;
    sum += g.weight * static_cast<long double>(g.mean);
    largest = std::max(largest, std::abs(static_cast<long double>(g.mean)));
  }
  const long double mean = sum / weight;
  for (const Group& g : groups) m2 += g.weight * (g.mean - mean) * (g.mean - mean);
  const double n = static_cast<double>(groups.size()), eps = 2.3e-16;
  EXPECT_EQ(m.groups, static_cast<int64_t>(groups.size()));
  EXPECT_EQ(m.weight, static_cast<double>(weight));
  EXPECT_NEAR(m.mean, static_cast<double>(mean), n * eps * static_cast<double>(largest));
  // Chan, Golub & LeVeque 1983: relative error of m2 is about n eps sqrt(1 + mean² W / m2).
  const double condition = std::sqrt(1 + static_cast<double>(mean * mean * weight / m2));
  EXPECT_NEAR(m.m2, static_cast<double>(m2), n * eps * condition * static_cast<double>(m2));
}

TEST(Moments, AnySplitEqualsTheWhole) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    const auto groups = random_groups(64, seed);
    for (size_t cut : {size_t{0}, size_t{1}, size_t{17}, size_t{63}, size_t{64}}) {
      Moments m = accumulate(groups, 0, cut);
      m.merge(accumulate(groups, cut, groups.size()));
      expect_is_whole(m, groups);
    }
  }
}

TEST(Moments, IsStableFarFromZero) {
  const auto groups = random_groups(1000, 1, 1e6);
  Moments m = accumulate(groups, 0, 500);
  m.merge(accumulate(groups, 500, 1000));
  expect_is_whole(m, groups);
}

TEST(Moments, MergingNothingChangesNoBit) {
  const auto groups = random_groups(5, 3);
  const Moments whole = accumulate(groups, 0, 5);
  Moments left, right = whole;
  left.merge(whole);
  right.merge(Moments{});
  for (const Moments& m : {left, right}) {
    EXPECT_EQ(m.mean, whole.mean);
    EXPECT_EQ(m.m2, whole.m2);
    EXPECT_EQ(m.weight, whole.weight);
    EXPECT_EQ(m.groups, whole.groups);
  }
}

TEST(Moments, VarianceOfMeanIsUnbiasedForUnequalWeights) {
  // Groups of w passes, each pass of variance 4: the mean of W passes has variance 4 / W.
  std::mt19937_64 random(7);
  std::normal_distribution<double> pass(3, 2);
  double sum = 0;
  constexpr int kTrials = 20000;
  double weight = 0;
  for (int t = 0; t < kTrials; ++t) {
    Moments m;
    for (const int w : {1, 4, 2, 8}) {
      double mean = 0;
      for (int i = 0; i < w; ++i) mean += pass(random) / w;
      m.add(mean, w);
    }
    sum += m.variance_of_mean();
    weight = m.weight;
  }
  // χ² with 3 degrees of freedom: relative standard error sqrt(2/3/trials) = 0.58 %; five of them.
  EXPECT_NEAR(sum / kTrials, 4 / weight, 5 * 0.0058 * 4 / weight);
}

TEST(Moments, OneGroupHasNoVariance) {
  Moments m;
  EXPECT_EQ(m.variance_of_mean(), 0);
  m.add(2.5, 16);
  EXPECT_EQ(m.variance_of_mean(), 0);
  EXPECT_EQ(m.mean, 2.5);
}

TEST(MomentsDeathTest, AGroupWithoutPassesIsAProgrammersFault) {
  Moments m;
  EXPECT_DEATH(m.add(1, 0), "group_weight > 0");
}

}  // namespace
}  // namespace penumbra
