#include "worker/lights/line.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "worker/lights/chord_measure.h"
#include "worker/lights/chords.h"

namespace penumbra {
namespace {

using std::numbers::pi;

const LightShape kRectangle = QuadShape{{-1, -0.5f, 0}, {2, 0, 0}, {0, 1, 0}};
const LightShape kSkew = QuadShape{{0, 0, 0}, {2, 0, 0}, {1, 1, 0}};
const LightShape kTriangle = TriangleShape{{0, 0, 0}, {4, 0, 0}, {0, 2, 0}};
const LightShape kSphere = SphereShape{{0, 0, 0}, 1, false};
const Vec3d kX(0.3, 0.2, 1.5);

constexpr std::array<Interval, 1> kWhole = {Interval{0, 1}};

TEST(LineStrategies, ShapesTheyServe) {
  EXPECT_TRUE(has_line_area(kRectangle) && has_line_area(kSkew) && has_line_area(kTriangle));
  EXPECT_FALSE(has_line_area(kSphere));
  EXPECT_TRUE(has_line_solid_angle(kRectangle) && has_line_solid_angle(kTriangle));
  EXPECT_FALSE(has_line_solid_angle(kSkew) || has_line_solid_angle(kSphere));
  // Where there are none, there is a line on which nothing has a density.
  const LightLine none = choose_line_area(kSphere, 0.3, 0.5);
  EXPECT_EQ(sample_line(none, kX, kWhole, 0.5).pdf, 0);
  const SeenShape skew(kSkew, kX);
  EXPECT_EQ(choose_line_solid_angle(skew, true, 0.5).scale, 0);
}

TEST(LineArea, AngleZeroRunsAlongTheFirstEdge) {
  const LightLine line = choose_line_area(kRectangle, 0, 0.25);
  EXPECT_NEAR((line.a - Vec3d(-1, -0.25, 0)).length(), 0, 1e-15);
  EXPECT_NEAR((line.b - Vec3d(1, -0.25, 0)).length(), 0, 1e-15);
  EXPECT_EQ(line.n, Vec3d(0, 0, 1));
  EXPECT_DOUBLE_EQ(line.scale, 0.5);
}

TEST(LineArea, AngleNinetyRunsTowardsTheSecondEdge) {
  // Offsets grow to the left of the direction: from the far end of u towards its start.
  const LightLine line = choose_line_area(kRectangle, pi / 2, 0.25);
  EXPECT_NEAR((line.a - Vec3d(0.5, -0.5, 0)).length(), 0, 1e-15);
  EXPECT_NEAR((line.b - Vec3d(0.5, 0.5, 0)).length(), 0, 1e-15);
}

TEST(LineArea, TriangleOffsetsFollowTheChordLength) {
  // Parallel to p0→p1 at height t the chord is 4(1 − t/2) long: half the area lies below t = 2 − √2.
  const LightLine line = choose_line_area(kTriangle, 0, 0.5);
  EXPECT_NEAR(line.a.y, 2 - std::sqrt(2), 1e-14);
  EXPECT_NEAR(line.along.length(), 4 * (1 - line.a.y / 2), 1e-14);
  // Next to the tip the length is √(1−u) of the base's, to full relative accuracy.
  const double u = 1 - 0x1p-40;
  EXPECT_NEAR(choose_line_area(kTriangle, 0, u).along.length() / (4 * 0x1p-20), 1, 1e-12);
}

TEST(LineArea, EveryChordLiesInTheLightAndHasItsDirection) {
  for (const LightShape& shape : {kRectangle, kSkew, kTriangle})
    for (const double degrees : {0.0, 26.565051177077994, 45.0, 90.0, 153.43494882292202, 179.0})
      for (int i = 0; i <= 20; ++i) {
        const double radians = degrees * pi / 180;
        const LightLine line = ParallelChords(shape, radians).choose(i == 20 ? 1 - 0x1p-53 : i / 20.0);
        const Vec3d direction(std::cos(radians), std::sin(radians), 0);
        EXPECT_NEAR(line.along.cross(direction).length(), 0, 1e-14) << degrees;
        EXPECT_GE(line.along.dot(direction), -1e-14);
        for (const Vec3d& end : {line.a, line.b}) {
          const SeenShape seen(shape, kX);
          const LightLine again = line_area_through(shape, radians, end);
          EXPECT_NEAR((again.a - line.a).cross(direction).length(), 0, 1e-12);
          const double inside = std::visit(
              [&](const auto& s) -> double {
                if constexpr (std::is_same_v<std::decay_t<decltype(s)>, QuadShape>) {
                  const Vec3d u(s.u), v(s.v), d = end - Vec3d(s.o), n = u.cross(v);
                  const double a = d.cross(v).dot(n) / n.length2(), b = u.cross(d).dot(n) / n.length2();
                  return std::min({a, b, 1 - a, 1 - b});
                } else if constexpr (std::is_same_v<std::decay_t<decltype(s)>, TriangleShape>) {
                  return std::min({end.x / 4, end.y / 2, 1 - end.x / 4 - end.y / 2});
                }
                return -1;
              },
              shape);
          EXPECT_NEAR(inside, 0, 1e-14) << degrees;  // on the border
        }
      }
}

TEST(LineSolidAngle, LinesAreParallelToTheirEdge) {
  const SeenShape seen(kRectangle, kX);
  const LightLine u = choose_line_solid_angle(seen, true, 0.4), v = choose_line_solid_angle(seen, false, 0.4);
  EXPECT_EQ(u.along, Vec3d(2, 0, 0));
  EXPECT_EQ(v.along, Vec3d(0, 1, 0));
  EXPECT_DOUBLE_EQ(u.scale, 1 / seen.solid_angle());
  // Left of the line lies the share u of the solid angle.
  const LightShape left = QuadShape{{-1, -0.5f, 0}, {static_cast<float>(v.a.x + 1), 0, 0}, {0, 1, 0}};
  EXPECT_NEAR(SeenShape(left, kX).solid_angle() / seen.solid_angle(), 0.4, 1e-6);
}

TEST(LineSolidAngle, ThroughAPointFindsTheSampledChord) {
  const SeenShape seen(kRectangle, kX);
  for (const bool along_u : {true, false}) {
    const LightLine line = choose_line_solid_angle(seen, along_u, 0.7);
    const LightPoint p = sample_line(line, kX, kWhole, 0.2);
    const LightLine again = line_solid_angle_through(seen, along_u, p.p);
    EXPECT_NEAR((again.a - line.a).length(), 0, 1e-14);
    EXPECT_NEAR(pdf_line(again, kX, parameter_of(again, p.p), 1), p.pdf, 1e-12 * p.pdf);
  }
}

TEST(LineSample, FallsIntoTheVisibleIntervalsOnly) {
  const SeenShape seen(kRectangle, kX);
  const std::array visible = {Interval{0.1f, 0.2f}, Interval{0.25f, 0.25000003f}, Interval{0.7f, 0.9f}};
  for (const LightLine& line : {choose_line_solid_angle(seen, false, 0.3), choose_line_area(kSkew, 1, 0.6)}) {
    const double measure = visible_measure(line, visible);
    int counts[3] = {0, 0, 0};
    for (int i = 0; i < 1000; ++i) {
      const double s = sample_parameter(line, visible, measure, (i + 0.5) / 1000);
      bool found = false;
      for (int k = 0; k < 3; ++k)
        if (s >= visible[k].lo && s <= visible[k].hi) {
          ++counts[k];
          found = true;
        }
      EXPECT_TRUE(found) << s;
    }
    EXPECT_NEAR(counts[0] / 1000.0, relative_measure(line, 0.1f, 0.2f) / measure, 2e-3);
    EXPECT_NEAR(counts[2] / 1000.0, relative_measure(line, 0.7f, 0.9f) / measure, 2e-3);
  }
}

TEST(LineSample, NothingVisibleHasNoDensity) {
  const LightLine line = choose_line_area(kRectangle, 0.3, 0.5);
  EXPECT_EQ(sample_line(line, kX, {}, 0.5).pdf, 0);
  EXPECT_EQ(pdf_line(line, kX, 0.5, 0), 0);
  // From behind, and in the light's plane.
  EXPECT_EQ(sample_line(line, {0.3, 0.2, -1.5}, kWhole, 0.5).pdf, 0);
  EXPECT_EQ(sample_line(line, {5, 0.2, 0}, kWhole, 0.5).pdf, 0);
  const SeenShape behind(kRectangle, {0.3, 0.2, -1.5});
  EXPECT_EQ(sample_line(choose_line_solid_angle(behind, true, 0.5), behind.x(), kWhole, 0.5).pdf, 0);
}

TEST(LineSample, HidingHalfDoublesTheDensity) {
  const LightLine line = choose_line_area(kRectangle, 0, 0.5);
  const std::array half = {Interval{0, 0.5f}};
  const LightPoint p = sample_line(line, kX, half, 0.5);
  EXPECT_NEAR((p.p - Vec3d(-0.5, 0, 0)).length(), 0, 1e-15);
  EXPECT_DOUBLE_EQ(p.pdf, 2 * pdf_area(kRectangle, kX, p.p, p.n));
}

TEST(ChordMeasure, PartsAddUpAndInvert) {
  for (const double y0 : {-0.3, -2.0, 0.5, 1e4, -1e6})
    for (const double d2 : {1.0, 1e-12, 1e8}) {
      const double whole = height_difference(y0, 2, d2);
      EXPECT_NEAR((height_difference(y0, 0.5, d2) + height_difference(y0 + 0.5, 1.5, d2)) / whole, 1, 1e-13);
      for (const double v : {0.0, 0.1, 0.5, 0.999, 1.0}) {
        const double t = sample_height(y0, 2, d2, v);
        EXPECT_TRUE(t >= 0 && t <= 2);
        EXPECT_NEAR(height_difference(y0, t, d2) / whole, v, 1e-9) << y0 << ' ' << d2;
      }
    }
}

TEST(RelativeMeasure, OfTheWholeChordIsOne) {
  const SeenShape seen(kRectangle, kX);
  EXPECT_EQ(relative_measure(choose_line_solid_angle(seen, true, 0.37), 0, 1), 1);
  EXPECT_EQ(relative_measure(choose_line_area(kSkew, 0.4, 0.37), 0, 1), 1);
  EXPECT_EQ(relative_measure(choose_line_area(kSkew, 0.4, 0.37), 0.6, 0.6), 0);
}

TEST(ParameterOf, IsTheInverseOfThePoint) {
  const LightLine line = choose_line_area(kTriangle, 1, 0.4);
  EXPECT_NEAR(parameter_of(line, line.a + 0.3 * line.along), 0.3, 1e-14);
  EXPECT_EQ(parameter_of(line, line.a - line.along), 0);
  EXPECT_EQ(parameter_of(line, line.b + line.along), 1);
}

TEST(Horizon, ClipsTheChord) {
  const LightLine line = choose_line_area(kRectangle, 0, 0.5);  // (−1,0,0) → (1,0,0)
  const Vec3d x(0, 0, 1);
  EXPECT_EQ(clip_to_horizon(line, x, {0, 0, -1}), (Interval{0, 1}));
  EXPECT_GE(clip_to_horizon(line, x, {0, 0, 1}).lo, clip_to_horizon(line, x, {0, 0, 1}).hi);
  const Interval right = clip_to_horizon(line, {0.5, 0, 1}, {1, 0, 0});
  EXPECT_NEAR(right.lo, 0.75, 1e-6);
  EXPECT_LE(right.lo, 0.75f);  // rounded outwards
  EXPECT_EQ(right.hi, 1);
  const Interval left = clip_to_horizon(line, {0.5, 0, 1}, {-1, 0, 0});
  EXPECT_EQ(left.lo, 0);
  EXPECT_NEAR(left.hi, 0.75, 1e-6);
  EXPECT_GE(left.hi, 0.75f);
}

}  // namespace
}  // namespace penumbra
