#include "worker/geometry/intervals.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>

namespace penumbra {
namespace {

std::vector<Interval> items(const IntervalSet& set) {
  return {set.begin(), set.end()};
}
using Items = std::vector<Interval>;

IntervalSet whole() {
  IntervalSet set;
  set.reset();
  return set;
}

TEST(IntervalSet, StartsEmptyAndResetsToOneInterval) {
  IntervalSet set;
  EXPECT_TRUE(set.empty());
  set.reset(0.25f, 0.5f);
  EXPECT_EQ(items(set), (Items{{0.25f, 0.5f}}));
  set.reset(0.5f, 0.5f);
  EXPECT_TRUE(set.empty());
}

TEST(IntervalSet, SubtractsFromTheMiddleTheEndsAndEverything) {
  IntervalSet set = whole();
  EXPECT_TRUE(set.subtract(0.25f, 0.5f));
  EXPECT_EQ(items(set), (Items{{0, 0.25f}, {0.5f, 1}}));
  EXPECT_TRUE(set.subtract(-1, 0.125f));
  EXPECT_TRUE(set.subtract(0.75f, 2));
  EXPECT_EQ(items(set), (Items{{0.125f, 0.25f}, {0.5f, 0.75f}}));
  EXPECT_TRUE(set.subtract(0.2f, 0.6f));
  EXPECT_EQ(items(set), (Items{{0.125f, 0.2f}, {0.6f, 0.75f}}));
  EXPECT_TRUE(set.subtract(0, 1));
  EXPECT_TRUE(set.empty());
}

TEST(IntervalSet, NothingIsRemovedByEmptyReversedForeignOrNan) {
  IntervalSet set = whole();
  set.subtract(0.25f, 0.5f);
  const IntervalSet before = set;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_FALSE(set.subtract(0.7f, 0.7f));
  EXPECT_FALSE(set.subtract(0.8f, 0.7f));
  EXPECT_FALSE(set.subtract(0.25f, 0.5f));
  EXPECT_FALSE(set.subtract(1, 2));
  EXPECT_FALSE(set.subtract(nan, 0.5f));
  EXPECT_FALSE(set.subtract(0.1f, nan));
  EXPECT_EQ(set, before);
}

TEST(IntervalSet, NeighboursWithACommonEndLeaveNothingBetween) {
  IntervalSet set = whole();
  const float shared = 0.333333343f;
  set.subtract(0.1f, shared);
  set.subtract(shared, 0.7f);
  EXPECT_EQ(items(set), (Items{{0, 0.1f}, {0.7f, 1}}));
}

TEST(IntervalSet, AppendsInOrderAndMergesWhatTouches) {
  IntervalSet set;
  set.append(0, 0.25f);
  set.append(0.25f, 0.5f);
  set.append(0.6f, 0.6f);
  set.append(0.75f, 1);
  EXPECT_EQ(items(set), (Items{{0, 0.5f}, {0.75f, 1}}));
  EXPECT_DEATH(set.append(0.5f, 0.6f), "check failed");
}

TEST(IntervalSet, LengthAndContains) {
  IntervalSet set = whole();
  set.subtract(0.25f, 0.75f);
  EXPECT_EQ(set.length(), 0.5f);
  EXPECT_TRUE(set.contains(0.25f));
  EXPECT_FALSE(set.contains(0.5f));
  EXPECT_TRUE(set.contains(0.75f));
}

/// Against cells of a grid: any order of subtraction gives the same set.
TEST(IntervalSet, RandomSubtractionsMatchAGridInAnyOrder) {
  constexpr int kCells = 256;
  std::mt19937 random(1);
  for (int round = 0; round < 500; ++round) {
    std::vector<std::pair<int, int>> cuts;
    std::vector<bool> visible(kCells, true);
    for (int i = 0; i < 30; ++i) {
      const int lo = static_cast<int>(random() % kCells), hi = std::min<int>(kCells, lo + random() % 20);
      cuts.emplace_back(lo, hi);
      for (int cell = lo; cell < hi; ++cell) visible[cell] = false;
    }
    IntervalSet expected;
    for (int cell = 0; cell < kCells; ++cell) {
      if (visible[cell]) expected.append(float(cell) / kCells, float(cell + 1) / kCells);
    }
    for (int order = 0; order < 3; ++order) {
      std::shuffle(cuts.begin(), cuts.end(), random);
      IntervalSet set = whole();
      for (const auto& [lo, hi] : cuts) {
        const IntervalSet before = set;
        const bool changed = set.subtract(float(lo) / kCells, float(hi) / kCells);
        EXPECT_EQ(changed, !(set == before));
      }
      ASSERT_EQ(set, expected);
    }
  }
}

}  // namespace
}  // namespace penumbra
