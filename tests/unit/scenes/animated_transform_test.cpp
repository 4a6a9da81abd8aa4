// pbrt's interpolation against placements written by hand.
#include "scenes/animated_transform.h"

#include <gtest/gtest.h>

#include <cmath>

#include "scenes/transforms.h"

namespace penumbra {
namespace {

/// As pbrt text has it: `Translate at  Rotate degrees axis  Scale by`.
Matrix placed(const Vec3d& at, double degrees, const Vec3d& axis, const Vec3d& by) {
  return scaling(by) * rotation(degrees, axis).value() * translation(at);
}

double largest(const Matrix& m) {
  double most = 0;
  for (int i = 0; i < 4; ++i)
    for (int k = 0; k < 4; ++k) most = std::max(most, std::abs(m[i][k]));
  return most;
}

void expect_near(const Matrix& a, const Matrix& b) {
  EXPECT_LE(largest(a - b), 1e-13 * largest(b)) << a << "not\n" << b;
}

TEST(AnimatedTransform, ItsPartsAreInterpolatedEachInItsOwnWay) {
  const Vec3d axis(1, -2, 0.5);
  for (const double size : {1e-9, 1.0, 1e9}) {
    const auto at = [&](double t) {
      return placed(Vec3d(1 + 3 * t, -2 * t, 5) * size, 10 + 120 * t, axis, Vec3d(1 + t, 2 - t, 3) * size);
    };
    const auto motion = AnimatedTransform::between(at(0), at(1), {0, 1}).value();
    EXPECT_EQ(motion.at(0), at(0));
    EXPECT_EQ(motion.at(1), at(1));
    for (const double t : {1e-6, 0.2, 0.5, 0.9}) expect_near(motion.at(t), at(t));
  }
}

TEST(AnimatedTransform, TheShorterWayRound) {
  const auto turned = [](double degrees) { return rotation(degrees, {0, 0, 1}).value(); };
  const auto motion = AnimatedTransform::between(turned(0), turned(270), {0, 1}).value();
  expect_near(motion.at(0.5), turned(-45));
  // By way of half a turn, where a rotation's two quaternions change places.
  expect_near(AnimatedTransform::between(turned(170), turned(200), {0, 1}).value().at(0.5), turned(185));
}

TEST(AnimatedTransform, ATranslationKeepsTheLinearPartToTheBit) {
  const Matrix start = placed({1, 2, 3}, 33, {1, 1, 0}, {1, 5, 0.1}), end = start * translation({4, 0, 0});
  const Matrix middle = AnimatedTransform::between(start, end, {0, 1}).value().at(0.5);
  EXPECT_EQ(middle, start * translation({2, 0, 0}));
}

TEST(AnimatedTransform, MirrorsStayMirrors) {
  const auto at = [](double t) { return scaling({-1, 1, 1}) * rotation(60 * t, {0, 1, 0}).value(); };
  const auto motion = AnimatedTransform::between(at(0), at(1), {0, 1}).value();
  expect_near(motion.at(0.3), at(0.3));
  EXPECT_FALSE(AnimatedTransform::between(Matrix(), scaling({1, 1, -1}), {0, 1}));
}

TEST(AnimatedTransform, TheShutterSeesAPartOfItAndPbrtHoldsTheEnds) {
  const auto motion = AnimatedTransform::between(Matrix(), translation({1, 0, 0}), {-0.5, 1.5}).value();
  for (const double u : {0.0, 0.1, 0.25, 0.5, 0.7, 0.75, 1.0})
    EXPECT_DOUBLE_EQ(motion.at(u)[3][0], std::clamp(2 * u - 0.5, 0.0, 1.0)) << u;
  const auto late = AnimatedTransform::between(Matrix(), translation({1, 0, 0}), {0.5, 0.75}).value();
  EXPECT_DOUBLE_EQ(late.at(0)[3][0], 0.5);
  EXPECT_DOUBLE_EQ(late.at(1)[3][0], 0.75);
}

/// At every time every corner lies in the interpolation of the two boxes next to that time.
TEST(AnimatedTransform, BoxesHoldTheObjectAtAllTimes) {
  const MovedBox object{Vec3d(-1, -0.2, 0), Vec3d(2, 0.3, 0.5)};
  for (const double degrees : {0.0, 3.0, 90.0, 179.0})
    for (const double growth : {0.0, 0.3, 9.0})
      for (const Shutter shutter : {Shutter{0, 1}, Shutter{-0.3, 1.2}, Shutter{0.2, 0.3}}) {
        const auto motion =
            AnimatedTransform::between(
                placed({0, 0, 0}, 20, {0, 1, 1}, {1, 1, 1}),
                placed({7, -3, 1}, 20 + degrees, {0, 1, 1}, {1 + growth, 1, 1 + growth}), shutter)
                .value();
        const auto boxes = motion.boxes(object);
        ASSERT_GE(boxes.size(), 2u);
        const auto n = static_cast<double>(boxes.size() - 1);
        for (double u = 0; u <= 1; u += 1.0 / 1024) {
          const auto before = std::min(static_cast<size_t>(u * n), boxes.size() - 2);
          const double s = u * n - static_cast<double>(before);
          const Vec3d lo = boxes[before].lo * (1 - s) + boxes[before + 1].lo * s;
          const Vec3d hi = boxes[before].hi * (1 - s) + boxes[before + 1].hi * s;
          for (int corner = 0; corner < 8; ++corner) {
            const Vec3d c(corner & 1 ? object.hi.x : object.lo.x, corner & 2 ? object.hi.y : object.lo.y,
                          corner & 4 ? object.hi.z : object.lo.z);
            Vec3d p;
            motion.at(u).multVecMatrix(c, p);
            for (int k = 0; k < 3; ++k) {
              ASSERT_LE(lo[k], p[k] + 1e-12) << degrees << ' ' << growth << ' ' << u;
              ASSERT_GE(hi[k], p[k] - 1e-12) << degrees << ' ' << growth << ' ' << u;
            }
          }
        }
      }
}

}  // namespace
}  // namespace penumbra
