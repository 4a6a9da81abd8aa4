#include "worker/strategies/smoothing.h"

#include <gtest/gtest.h>

#include <vector>

namespace penumbra {
namespace {

constexpr Smoothing kWide{SmoothShape::kCubic, 0.5};

/// A line of length 2 along x.
LightLine line() {
  LightLine l;
  l.along = {2, 0, 0};
  l.b = l.along;
  l.n = {0, 0, 1};
  l.scale = 1;
  return l;
}

double factor(const std::vector<Interval>& visible, double s, const Smoothing& smoothing = kWide) {
  return line_factor(smoothing, line(), visible, s);
}

TEST(Rise, BothShapesGoFromZeroToOne) {
  for (const SmoothShape shape : {SmoothShape::kCubic, SmoothShape::kEaseIn}) {
    EXPECT_EQ(rise(shape, 0), 0);
    EXPECT_EQ(rise(shape, -3), 0);
    EXPECT_EQ(rise(shape, 1), 1);
    EXPECT_EQ(rise(shape, 7), 1);
    for (double t = 0; t < 1; t += 0.01) EXPECT_LT(rise(shape, t), rise(shape, t + 0.01));
  }
  EXPECT_DOUBLE_EQ(rise(SmoothShape::kCubic, 0.25), 0.15625);
  EXPECT_DOUBLE_EQ(rise(SmoothShape::kEaseIn, 0.25), 0.4375);
}

TEST(BorderFactor, FallsToZeroOnEveryEdge) {
  const QuadShape quad{{1, 2, 3}, {4, 0, 0}, {1, 3, 0}};
  const TriangleShape triangle{{1, 2, 3}, {5, 2, 3}, {2, 5, 3}};
  const auto at = [](double s, double t) { return Vec3d(1 + 4 * s + t, 2 + 3 * t, 3); };
  for (double e = 0.1; e < 1; e += 0.2) {
    for (const Vec3d& p : {at(e, 0), at(e, 1), at(0, e), at(1, e)})
      EXPECT_NEAR(border_factor(kWide, quad, p), 0, 1e-12);
    for (const Vec3d& p : {at(e, 0), at(0, e), at(e, 1 - e)})
      EXPECT_NEAR(border_factor(kWide, triangle, p), 0, 1e-12);
  }
  EXPECT_EQ(border_factor(kWide, quad, at(0.5, 0.5)), 1);
  EXPECT_DOUBLE_EQ(border_factor(kWide, quad, at(0.5, 0.25 / 3)), 0.5);  // half a width from the lower edge
  EXPECT_EQ(border_factor(kWide, SphereShape{}, {0, 0, 1}), 1);
  // `auto` does not know scene units.
  const Smoothing automatic;
  const QuadShape large{{1000, 2000, 3000}, {4000, 0, 0}, {1000, 3000, 0}};
  for (double t : {0.01, 0.1, 0.2})
    EXPECT_NEAR(border_factor(automatic, quad, at(0.4, t)),
                border_factor(automatic, large, 1000.0 * at(0.4, t)), 1e-14);
}

TEST(LineFactor, IsOneWhereNothingIsHidden) {
  for (double s = 0; s <= 1; s += 0.125) EXPECT_EQ(factor({{0, 1}}, s), 1);
}

TEST(LineFactor, FallsToZeroAtAGapAndReachesOneAWidthAway) {
  const std::vector<Interval> visible{{0, 0.5f}, {0.875f, 1}};
  EXPECT_EQ(factor(visible, 0.5), 0);
  EXPECT_EQ(factor(visible, 0.875), 0);
  EXPECT_EQ(factor(visible, 0.7), 0);
  EXPECT_DOUBLE_EQ(factor(visible, 0.375), 0.5);  // 0.25 away of 0.5
  EXPECT_EQ(factor(visible, 0.25), 1);
  EXPECT_LT(factor(visible, 1), 1);
  EXPECT_EQ(factor({}, 0.5), 0);
  EXPECT_EQ(factor({{0.25f, 1}}, 0.25), 0) << "a gap at the chord's end is a gap";
}

TEST(LineFactor, AGapTakesItsEffectWithItAsItCloses) {
  double last = 0;
  for (const float half : {0x1p-3f, 0x1p-5f, 0x1p-7f, 0x1p-9f, 0x1p-11f}) {
    const std::vector<Interval> visible{{0, 0.5f - half}, {0.5f + half, 1}};
    EXPECT_EQ(factor(visible, 0.5 - half), 0);
    const double near = factor(visible, 0.5 - 0x1p-3 - 0x1p-8);
    EXPECT_GE(near, last);
    last = near;
  }
  EXPECT_EQ(last, 1);
}

TEST(LineFactor, ASliverThatClosesBetweenTwoGapsJoinsThem) {
  const double joined = factor({{0, 0.5f}, {0.625f, 1}}, 0.4375);
  double distance = 1;
  for (const float sliver : {0x1p-5f, 0x1p-8f, 0x1p-11f, 0x1p-14f, 0x1p-17f}) {
    const std::vector<Interval> visible{{0, 0.5f}, {0.5625f, 0.5625f + sliver}, {0.625f, 1}};
    const double d = std::abs(factor(visible, 0.4375) - joined);
    EXPECT_LT(d, distance);
    distance = d;
  }
  EXPECT_LT(distance, 0x1p-12);  // of the order of sliver / gap
}

TEST(LineFactor, LooksBothWays) {
  const std::vector<Interval> visible{{0.125f, 0.5f}, {0.75f, 1}}, mirrored{{0, 0.25f}, {0.5f, 0.875f}};
  for (double s = 0; s <= 1; s += 0x1p-5) EXPECT_DOUBLE_EQ(factor(visible, s), factor(mirrored, 1 - s)) << s;
}

}  // namespace
}  // namespace penumbra
