#include "worker/lights/shape.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace penumbra {
namespace {

using std::numbers::pi;

const QuadShape kQuad{{-1, -0.5f, 0}, {2, 0, 0}, {0, 1, 0}};
const TriangleShape kTriangle{{0, 0, 0}, {2, 0, 0}, {0.5f, 1, 0}};

TEST(QuadShape, KnowsARightAngleToRounding) {
  EXPECT_TRUE(kQuad.rectangle());
  // Rotated by 0.3 rad about z, in floats.
  const float c = std::cos(0.3f), s = std::sin(0.3f);
  EXPECT_TRUE((QuadShape{{0, 0, 0}, {3 * c, 3 * s, 0}, {-s, c, 0}}).rectangle());
  EXPECT_FALSE((QuadShape{{0, 0, 0}, {1, 0, 0}, {1e-5f, 1, 0}}).rectangle());
  EXPECT_FALSE((QuadShape{{0, 0, 0}, {1, 0, 0}, {0.7f, 1, 0}}).rectangle());
}

TEST(LightShape, Areas) {
  EXPECT_DOUBLE_EQ(area(LightShape(kQuad)), 2);
  EXPECT_DOUBLE_EQ(area(LightShape(QuadShape{{0, 0, 0}, {1, 0, 0}, {5, 1, 0}})), 1);
  EXPECT_DOUBLE_EQ(area(LightShape(kTriangle)), 1);
  EXPECT_DOUBLE_EQ(area(LightShape(SphereShape{{1, 2, 3}, 2})), 16 * pi);
  EXPECT_DOUBLE_EQ(area(LightShape(DiskShape{{0, 0, 0}, {0, 0, 1}, 2, 1})), 3 * pi);
  EXPECT_DOUBLE_EQ(area(LightShape(CylinderShape{{0, 0, 0}, {0, 0, 3}, 2})), 12 * pi);
}

struct Facing {
  LightShape shape;
  Vec3d seen, unseen;
};

TEST(LightShape, DensitiesVanishForPointsThatFaceAway) {
  const Facing cases[] = {
      {kQuad, {0.2, 0.1, 1}, {0.2, 0.1, -1}},
      {kTriangle, {0.2, 0.1, 1}, {0.2, 0.1, -1}},
      {kQuad, {0.2, 0.1, 1}, {5, 0.1, 0}},
      {kTriangle, {0.2, 0.1, 1}, {-5, 0.1, 0}},
      {QuadShape{{0, 0, 0}, {1, 0, 0}, {0.5f, 1, 0}}, {0.2, 0.1, 1}, {0.2, 0.1, -1}},
      {DiskShape{{0, 0, 0}, {0, 0, 1}, 1, 0}, {0, 0, 1}, {0, 0, -1}},
      {SphereShape{{0, 0, 0}, 1, false}, {0, 0, 3}, {0, 0, 0.5}},
      {CylinderShape{{0, 0, 0}, {0, 0, 2}, 1, false}, {3, 0, 1}, {0, 0, 1}},

  };
  int number = 0;
  for (const Facing& f : cases) {
    const SeenShape seen(f.shape, f.seen), unseen(f.shape, f.unseen);
    int hits = 0;
    for (int i = 0; i < 64; ++i) {
      const Vec2d u((i % 8 + 0.5) / 8, (i / 8 + 0.5) / 8);
      hits += sample_area(f.shape, f.seen, u).pdf > 0;
      const LightPoint from_behind = sample_area(f.shape, f.unseen, u), angular = unseen.sample(u);
      EXPECT_EQ(from_behind.pdf, 0) << number;
      EXPECT_EQ(angular.pdf, 0) << number;
      EXPECT_EQ(unseen.pdf(from_behind.p, from_behind.n), 0) << number;
    }
    EXPECT_GT(hits, 0) << number;
    if (seen.has_solid_angle()) {
      EXPECT_GT(seen.solid_angle(), 0) << number;
      EXPECT_EQ(unseen.solid_angle(), 0) << number;
    }
    ++number;
  }
}

TEST(LightShape, NormalsPointToTheEmissionSide) {
  for (int i = 0; i < 16; ++i) {
    const Vec2d u((i % 4 + 0.5) / 4, (i / 4 + 0.5) / 4);
    const Vec3d center(1, 2, 3);
    const LightPoint out = sample_area(SphereShape{{1, 2, 3}, 2, false}, {9, 9, 9}, u);
    EXPECT_NEAR((out.p - center).dot(out.n), 2, 1e-14);
    const LightPoint in = sample_area(SphereShape{{1, 2, 3}, 2, true}, {1, 2, 3}, u);
    EXPECT_NEAR((in.p - center).dot(in.n), -2, 1e-14);
    EXPECT_NEAR(in.pdf, 1 / (4 * pi), 1e-15);  // from the centre every direction is as likely
    EXPECT_EQ(sample_area(kQuad, {0, 0, 1}, u).n, Vec3d(0, 0, 1));
  }
}

TEST(SeenShape, OnlyFlatLightsAndSpheresHaveAParametrisation) {
  const Vec3d x(0, 0, 5);
  const LightShape disk = DiskShape{{0, 0, 0}, {0, 0, 1}, 1, 0.5f},
                   tube = CylinderShape{{0, 0, 0}, {1, 0, 0}, 1};
  for (const LightShape* shape : {&disk, &tube}) {
    const SeenShape seen(*shape, x);
    EXPECT_FALSE(seen.has_solid_angle());
    const LightPoint p = seen.sample({0.3, 0.6}), q = sample_area(*shape, x, {0.3, 0.6});
    EXPECT_EQ(p.p, q.p);
    EXPECT_EQ(p.pdf, q.pdf);
  }
}

TEST(SeenShape, SphereFromOutsideInsideAndAfar) {
  const LightShape ball = SphereShape{{0, 0, 0}, 1, false}, shell = SphereShape{{0, 0, 0}, 1, true};
  EXPECT_NEAR(SeenShape(ball, {0, 0, 2}).solid_angle(), 2 * pi * (1 - std::sqrt(3) / 2), 1e-15);
  EXPECT_NEAR(SeenShape(shell, {0, 0, 0.5}).solid_angle(), 4 * pi, 1e-15);
  // π (R/d)² (1 + (R/d)²/4 + …), far beyond where 1 − cosθ has any digits left.
  EXPECT_NEAR(SeenShape(ball, {0, 0, 1e10}).solid_angle() / (pi * 1e-20), 1, 1e-15);
  EXPECT_EQ(SeenShape(ball, {0, 0, 1}).solid_angle(), 0);  // on the sphere: neither side is decided
  EXPECT_EQ(SeenShape(shell, {0, 0, 1}).solid_angle(), 0);
  // An inward sphere hides its own far side from outside.
  EXPECT_EQ(SeenShape(shell, {0, 0, 3}).solid_angle(), 0);
  // The far side of an outward sphere cannot be reached.
  EXPECT_EQ(SeenShape(ball, {0, 0, 2}).pdf({0, 0, -1}, {0, 0, -1}), 0);
  EXPECT_GT(SeenShape(ball, {0, 0, 2}).pdf({0, 0, 1}, {0, 0, 1}), 0);
}

TEST(SeenShape, DegenerateShapesAreNotSeen) {
  const LightShape flat = QuadShape{{0, 0, 0}, {1, 0, 0}, {0, 0, 0}},
                   line = TriangleShape{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  for (const LightShape* shape : {&flat, &line}) {
    const SeenShape seen(*shape, {0.3, 1, 1});
    EXPECT_EQ(seen.solid_angle(), 0);
    EXPECT_EQ(seen.sample({0.5, 0.5}).pdf, 0);
    EXPECT_EQ(sample_area(*shape, {0.3, 1, 1}, {0.5, 0.5}).pdf, 0);
  }
}

}  // namespace
}  // namespace penumbra
