#include "worker/effects/transient.h"

#include <gtest/gtest.h>

#include <map>

namespace penumbra {
namespace {

std::map<int, Vec3d> taken(TimeBins& bins) {
  std::map<int, Vec3d> out;
  bins.take([&](int bin, const Vec3d& value) { out[bin] = value; });
  return out;
}

LightLine line(const Vec3d& a, const Vec3d& b) {
  LightLine out;
  out.corner = a;
  out.along = b - a;
  return out;
}

std::vector<LinePart> cut(const TimeBins& bins, const LightLine& chord,
                          std::vector<Interval> visible = {{0, 1}}) {
  std::vector<LinePart> parts;
  bins.cut(chord, Vec3d(0), visible, parts);
  return parts;
}

TEST(TimeBins, ABinHoldsItsLowerEdgeAndNotItsUpper) {
  TimeBins bins(Transient{2, 5, 3});
  bins.stand_at(1, Rgb(1));
  for (const double distance : {0.999999, 1.0, 1.999999, 2.0, 3.999999, 4.0, double(INFINITY)})
    bins.add(distance, Rgb(1));
  const auto values = taken(bins);
  EXPECT_EQ(values.size(), 3u);
  EXPECT_EQ(values.at(0).x, 2);
  EXPECT_EQ(values.at(1).x, 1);
  EXPECT_EQ(values.at(2).x, 1);
  EXPECT_TRUE(taken(bins).empty()) << "taken twice";
}

TEST(TimeBins, EdgesThatAreNoDyadicNumbersDecideAlikeForPointsAndLines) {
  const Transient transient{0.1, 0.8, 7};
  TimeBins bins(transient);
  bins.stand_at(0, Rgb(1));
  for (int b = 0; b < transient.bins; ++b) {
    bins.add(transient.edge(b), Rgb(1));
    const auto at_edge = taken(bins);
    ASSERT_EQ(at_edge.size(), 1u);
    EXPECT_EQ(at_edge.begin()->first, b);
    bins.add(std::nextafter(transient.edge(b + 1), 0), Rgb(1));
    EXPECT_EQ(taken(bins).begin()->first, b);
  }
}

TEST(TimeBins, WeightsAndThroughputsMultiply) {
  TimeBins bins(Transient{0, 1, 1});
  bins.weigh(0.5);
  bins.stand_at(0, Rgb(1, 2, 4));
  bins.add(0.5, Rgb(3));
  EXPECT_EQ(taken(bins).at(0), Vec3d(1.5, 3, 6));
}

TEST(TimeBins, AChordIsCutAtEveryEdgeOnBothSidesOfItsFoot) {
  TimeBins bins(Transient{0, 10, 10});
  bins.stand_at(0.5, Rgb(1));
  // Distance 3 at the foot, 5 at both ends; the path's lengths are 3.5 to 5.5.
  const std::vector<LinePart> parts = cut(bins, line({-4, 3, 0}, {4, 3, 0}));
  ASSERT_EQ(parts.size(), 5u);
  double total = 0;
  for (const LinePart& part : parts) {
    total += part.hi - part.lo;
    for (const double s : {0.01, 0.5, 0.99}) {
      const double x = -4 + 8 * (part.lo + s * (part.hi - part.lo)), length = 0.5 + std::hypot(x, 3.0);
      EXPECT_EQ(int(length), part.bin);
    }
  }
  EXPECT_DOUBLE_EQ(total, 1);
  EXPECT_EQ(parts[0].bin, 3);
  EXPECT_EQ(parts[4].bin, 5);
}

TEST(TimeBins, WhatLiesInOneBinIsNotCut) {
  TimeBins bins(Transient{0, 100, 1});
  bins.stand_at(0, Rgb(1));
  const std::vector<LinePart> parts =
      cut(bins, line({-4, 3, 0}, {4, 3, 0}), {{0.125f, 0.25f}, {0.375f, 0.875f}});
  ASSERT_EQ(parts.size(), 2u);
  EXPECT_EQ(parts[0].lo, 0.125);
  EXPECT_EQ(parts[0].hi, 0.25);
  EXPECT_EQ(parts[1].lo, 0.375);
  EXPECT_EQ(parts[1].hi, 0.875);
}

TEST(TimeBins, ADistanceThatHardlyChangesAlongTheChord) {
  // A chord of length 1e-7 seen squarely from 1: its distances are one double.
  const LightLine chord = line({-5e-8, 1, 0}, {5e-8, 1, 0});
  for (const Transient& transient : {Transient{1, 2, 4}, Transient{0.5, 1, 4}, Transient{0.75, 1.25, 2}}) {
    TimeBins bins(transient);
    bins.stand_at(0, Rgb(1));
    double total = 0;
    for (const LinePart& part : cut(bins, chord)) {
      EXPECT_GE(part.lo, 0);
      EXPECT_LE(part.hi, 1);
      total += part.hi - part.lo;
    }
    // Either all of it arrives, or (below t1 = 1) nothing of it.
    EXPECT_EQ(total, transient.t1 > 1 ? 1 : 0);
  }
}

TEST(TimeBins, EdgesAtTheVeryEndsOfAChord) {
  // Seen along itself: distances 2 to 3, edges at 2, 2.5 and 3.
  TimeBins bins(Transient{2, 3, 2});
  bins.stand_at(0, Rgb(1));
  const std::vector<LinePart> parts = cut(bins, line({2, 0, 0}, {3, 0, 0}));
  ASSERT_EQ(parts.size(), 2u);
  EXPECT_EQ(parts[0].lo, 0);
  EXPECT_EQ(parts[0].hi, 0.5);
  EXPECT_EQ(parts[1].lo, 0.5);
  EXPECT_EQ(parts[1].hi, 1);
}

TEST(TimeBins, NothingOfAChordBeyondTheLastEdge) {
  TimeBins bins(Transient{0, 2.9, 100});
  bins.stand_at(0, Rgb(1));
  EXPECT_TRUE(cut(bins, line({-4, 3, 0}, {4, 3, 0})).empty());
}

TEST(TimeBins, AChordOfNoLength) {
  TimeBins bins(Transient{0, 4, 4});
  bins.stand_at(0, Rgb(1));
  const std::vector<LinePart> parts = cut(bins, line({0, 3, 0}, {0, 3, 0}));
  ASSERT_EQ(parts.size(), 1u);
  EXPECT_EQ(parts[0].bin, 3);
}

}  // namespace
}  // namespace penumbra
