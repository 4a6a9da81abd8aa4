// What is visible of a light, as convex pieces: areas and solid angles that can be said in advance, and every
// point against a test of one ray with every triangle.
#include "worker/lights/visible_region.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "worker/sampling/hash.h"
#include "worker/sampling/sampler.h"

namespace penumbra {
namespace {

using Triangle = std::array<Vec3f, 3>;

/// [0,1]² at z = 1, and the half of it where x + y < 1; both face down.
const QuadShape kQuad{{0, 0, 1}, {0, 1, 0}, {1, 0, 0}};
const TriangleShape kTriangle{{0, 0, 1}, {0, 1, 1}, {1, 0, 1}};
const Vec3d kNoHorizon(0, 0, 0), kMiddle(0.5, 0.5, 0);

class Random {
 public:
  explicit Random(uint64_t seed) : key_(seed) {}
  double uniform() { return penumbra::uniform(mix64(key_ = child_key(key_, 1))); }
  Vec3f in_box() {
    return Vec3f(float(uniform() * 1.6 - 0.3), float(uniform() * 1.6 - 0.3), float(uniform() * 1.4 - 0.2));
  }

 private:
  uint64_t key_;
};

/// Does the segment from x to p meet the triangle? Doubt, within `margin` of an edge or of an end: nothing.
std::optional<bool> meets(const Vec3d& x, const Vec3d& p, const Triangle& t, double margin) {
  const Vec3d d = p - x, e1 = Vec3d(t[1]) - Vec3d(t[0]), e2 = Vec3d(t[2]) - Vec3d(t[0]);
  const Vec3d h = d.cross(e2), s = x - Vec3d(t[0]);
  const double a = e1.dot(h);
  const double u = s.dot(h) / a, v = d.dot(s.cross(e1)) / a, at = e2.dot(s.cross(e1)) / a;
  const double inside = std::min({u, v, 1 - u - v, at, 1 - at});
  if (!(std::abs(inside) > margin)) return std::nullopt;
  return inside > 0;
}

VisibleRegion region_of(const LightShape& light, const Vec3d& x, const std::vector<Triangle>& occluders,
                        const Vec3d& horizon = kNoHorizon, double rounding = 0) {
  VisibleRegion region;
  region.reset(light, x, horizon, rounding);
  for (const Triangle& t : occluders) EXPECT_TRUE(region.subtract(t));
  region.finish();
  return region;
}

/// Two triangles of a rectangle at height z.
void add_plate(std::vector<Triangle>& to, float x0, float y0, float x1, float y1, float z) {
  const Vec3f a(x0, y0, z), b(x1, y0, z), c(x1, y1, z), d(x0, y1, z);
  to.push_back({a, b, c});
  to.push_back({a, c, d});
}

TEST(VisibleRegion, AllOfALightThatNothingHides) {
  for (const LightShape& light : {LightShape{kQuad}, LightShape{kTriangle}}) {
    const VisibleRegion region = region_of(light, kMiddle, {});
    EXPECT_TRUE(region.whole());
    EXPECT_DOUBLE_EQ(region.area_fraction(), 1);
    EXPECT_NEAR(region.solid_angle(), SeenShape(light, kMiddle).solid_angle(), 1e-14);
  }
  EXPECT_TRUE(region_of(kQuad, {0.5, 0.5, 2}, {}).empty()) << "seen from behind";
  EXPECT_TRUE(region_of(kQuad, {0.5, 0.5, 1}, {}).empty()) << "in its plane";
}

TEST(VisibleRegion, HalfCovered) {
  // At half the height up to the middle: the shadow is twice as large, its edge above the middle.
  std::vector<Triangle> plate;
  add_plate(plate, 0.5f, -1, 2, 2, 0.5f);
  const VisibleRegion region = region_of(kQuad, kMiddle, plate);
  EXPECT_FALSE(region.whole());
  EXPECT_NEAR(region.area_fraction(), 0.5, 1e-14);
  EXPECT_NEAR(region.solid_angle(), SeenShape(kQuad, kMiddle).solid_angle() / 2, 1e-14);
  EXPECT_TRUE(region.holds({0.49, 0.3, 1}));
  EXPECT_FALSE(region.holds({0.51, 0.3, 1}));
  EXPECT_GT(region.pdf({0.49, 0.3, 1}), 0);
  EXPECT_EQ(region.pdf({0.51, 0.3, 1}), 0);
}

TEST(VisibleRegion, AHoleInTheMiddle) {
  std::vector<Triangle> plate;
  add_plate(plate, 0.4f, 0.45f, 0.6f, 0.55f, 0.5f);  // shadow 0.4 × 0.2
  EXPECT_NEAR(region_of(kQuad, kMiddle, plate).area_fraction(), 1 - 0.08, 1e-7);
  // And the light seen through a hole.
  std::vector<Triangle> frame;
  add_plate(frame, -1, -1, 0.45f, 2, 0.5f);
  add_plate(frame, 0.55f, -1, 2, 2, 0.5f);
  add_plate(frame, 0.45f, -1, 0.55f, 0.45f, 0.5f);
  add_plate(frame, 0.45f, 0.55f, 0.55f, 2, 0.5f);
  EXPECT_NEAR(region_of(kQuad, kMiddle, frame).area_fraction(), 0.04, 1e-7);
}

TEST(VisibleRegion, TheHorizonCuts) {
  const Vec3d x(0.5, 0.5, 0), upright(1, 0, 0);
  const VisibleRegion half = region_of(kQuad, x, {}, upright);
  EXPECT_FALSE(half.whole());
  EXPECT_NEAR(half.area_fraction(), 0.5, 1e-15);
  EXPECT_TRUE(half.holds({0.6, 0.2, 1}));
  EXPECT_FALSE(half.holds({0.4, 0.2, 1}));
  EXPECT_TRUE(region_of(kQuad, x, {}, {0, 0, 1}).whole());
  EXPECT_TRUE(region_of(kQuad, x, {}, {0, 0, -1}).empty());
}

TEST(VisibleRegion, OnlyWhatLiesBetweenHides) {
  std::vector<Triangle> elsewhere;
  add_plate(elsewhere, -2, -2, 3, 3, -0.01f);                                   // behind x
  add_plate(elsewhere, -2, -2, 3, 3, 1);                                        // in the light's plane
  add_plate(elsewhere, -2, -2, 3, 3, 1.01f);                                    // beyond
  add_plate(elsewhere, 2, -2, 3, 3, 0.5f);                                      // beside
  elsewhere.push_back({{{0.5f, 0.5f, -1}, {0.5f, 0.5f, 2}, {0.5f, 5, 0.5f}}});  // edge on
  EXPECT_TRUE(region_of(kQuad, kMiddle, elsewhere).whole());
  // A wall through the light's plane hides what it does up to there.
  std::vector<Triangle> wall = {{{{0.6f, -4, 0.1f}, {0.6f, 4, 0.1f}, {0.6f, 4, 3}}},
                                {{{0.6f, -4, 0.1f}, {0.6f, 4, 3}, {0.6f, -4, 3}}}};
  EXPECT_NEAR(region_of(kQuad, kMiddle, wall).area_fraction(), 0.6, 1e-5);
}

TEST(VisibleRegion, TheWallAroundALightHidesNothing) {
  // In the light's plane but for the roundings of its corners, whatever way that lies.
  Random random(5);
  for (int round = 0; round < 100; ++round) {
    const Vec3d n = (Vec3d(random.in_box()) + Vec3d(0.31)).normalized();
    const Vec3d s = n.cross({0.2, 1, 0.1}).normalized(), t = s.cross(n), o = Vec3d(random.in_box()) * 30;
    const auto at = [&](double a, double b) { return Vec3f(o + s * a + t * b); };
    const QuadShape light{at(0, 0), Vec3f(t), Vec3f(s)};
    const Vec3d x = o + s * 0.4 + t * 0.3 + Vec3d(light.u).cross(Vec3d(light.v)) * 2.0;
    double rounding = 0;  // of corners within 2 of o, and of edges of length 1
    for (int k = 0; k < 3; ++k) rounding += 0x1p-24 * std::abs(n[k]) * (std::abs(o[k]) + 4);
    const VisibleRegion region =
        region_of(light, x, {{{at(-3, -3), at(5, -3), at(1, 6)}}}, kNoHorizon, rounding);
    EXPECT_TRUE(region.whole()) << round;
  }
}

TEST(VisibleRegion, ATriangulatedPlateHidesEverything) {
  // Neighbours share corners that are no round numbers; the plate is tilted and reaches behind x.
  Random random(7);
  for (int round = 0; round < 200; ++round) {
    constexpr int kCells = 4;
    Vec3f at[kCells + 1][kCells + 1];
    for (int i = 0; i <= kCells; ++i)
      for (int j = 0; j <= kCells; ++j) {
        const bool inner = i > 0 && i < kCells && j > 0 && j < kCells;
        const double shake = inner ? 0.3 : 0;
        at[i][j] = Vec3f(float(-4 + 9.0 * i / kCells + shake * random.uniform()),
                         float(-4 + 9.0 * j / kCells + shake * random.uniform()),
                         float(0.5 + 0.2 * (random.uniform() - 0.5)));
      }
    VisibleRegion region;
    region.reset(kQuad, Vec3d(random.uniform(), random.uniform(), 0), {0, 0, 1});
    for (int i = 0; i < kCells; ++i)
      for (int j = 0; j < kCells; ++j) {
        EXPECT_TRUE(region.subtract({at[i][j], at[i + 1][j], at[i + 1][j + 1]}));
        EXPECT_TRUE(region.subtract({at[i + 1][j + 1], at[i][j + 1], at[i][j]}));
      }
    EXPECT_TRUE(region.empty()) << round << ": " << region.area_fraction() << " in " << region.pieces();
  }
}

TEST(VisibleRegion, OverlappingTrianglesAgainstRays) {
  constexpr int kGrid = 48;
  Random random(3);
  int visible = 0, hidden = 0, regions = 0;
  for (int round = 0; round < 300; ++round) {
    const LightShape light = round % 3 == 0 ? LightShape{kTriangle} : LightShape{kQuad};
    const double full = round % 3 == 0 ? 0.5 : 1;
    const Vec3d x(random.uniform(), random.uniform(), 0.4 * random.uniform());
    std::vector<Triangle> occluders;
    for (int i = 0; i < 1 + round % 8; ++i)
      occluders.push_back({random.in_box(), random.in_box(), random.in_box()});
    VisibleRegion region;
    region.reset(light, x, kNoHorizon);
    bool few = true;
    for (const Triangle& t : occluders) few = few && region.subtract(t);
    if (!few) continue;
    ++regions;
    region.finish();
    double area = 0, solid_angle = 0;
    for (int i = 0; i < kGrid; ++i)
      for (int j = 0; j < kGrid; ++j) {
        const Vec3d p((j + 0.5) / kGrid, (i + 0.5) / kGrid, 1);
        if (full < 1 && i + j + 1 >= kGrid) continue;
        bool seen = true, sure = true;
        for (const Triangle& t : occluders) {
          const auto met = meets(x, p, t, 1e-4);
          sure &= met.has_value();
          seen &= !met.value_or(false);
        }
        if (sure) {
          ASSERT_EQ(region.holds(p), seen) << round << ": " << p.x << " " << p.y;
          ++(seen ? visible : hidden);
        }
        if (!seen) continue;
        const Vec3d d = p - x;
        area += 1.0 / (kGrid * kGrid);
        solid_angle += d.z / (d.length2() * d.length()) / (kGrid * kGrid);
      }
    EXPECT_NEAR(region.area_fraction(), area / full, 0.05) << round;
    const double whole = SeenShape(light, x).solid_angle();
    EXPECT_NEAR(region.solid_angle(), solid_angle, 0.05 * whole + 0.02) << round;
  }
  EXPECT_GT(regions, 250);
  EXPECT_GT(visible, 50000);
  EXPECT_GT(hidden, 50000);
}

TEST(VisibleRegion, SamplesLieInsideAtAnyScale) {
  Random random(11);
  for (const float scale : {1e-6f, 1.f, 1e6f})
    for (int round = 0; round < 60; ++round) {
      const auto scaled = [&](const Vec3f& p) { return p * scale; };
      const QuadShape light{scaled(kQuad.o), scaled(kQuad.u), scaled(kQuad.v)};
      const Vec3d x = Vec3d(scaled(Vec3f(0.3f, 0.6f, 0.1f)));
      std::vector<Triangle> occluders;
      for (int i = 0; i < 3; ++i) {
        Triangle t = {scaled(random.in_box()), scaled(random.in_box()), scaled(random.in_box())};
        if (round % 2 == 1) t[2] = t[1] + (t[1] - t[0]) * 1e-6f;  // a sliver
        occluders.push_back(t);
      }
      const VisibleRegion region = region_of(light, x, occluders);
      EXPECT_TRUE(std::isfinite(region.solid_angle()));
      if (region.whole() || region.empty()) continue;
      for (int i = 0; i < 40; ++i) {
        const LightPoint point = region.sample({random.uniform(), random.uniform()});
        ASSERT_TRUE(region.holds(point.p)) << round;
        ASSERT_EQ(region.pdf(point.p), point.pdf);
        ASSERT_TRUE(std::isfinite(point.pdf) && point.pdf > 0);
        for (const Triangle& t : occluders) EXPECT_NE(meets(x, point.p, t, 1e-4), true);
      }
    }
}

TEST(VisibleRegion, TooManyPiecesAreGivenUp) {
  VisibleRegion region;
  region.reset(kQuad, kMiddle, kNoHorizon);
  bool few = true;
  for (int i = 0; i < 200 && few; ++i) {
    const float at = 0.26f + 0.48f * float(i) / 200, y = 0.26f + 0.4f * float(i * 77 % 200) / 200;
    few = region.subtract({{{at, y, 0.5f}, {at + 0.001f, y, 0.5f}, {at, y + 0.002f, 0.5f}}});
    ASSERT_LE(region.pieces(), size_t(VisibleRegion::kMostPieces));
  }
  EXPECT_FALSE(few);
}

}  // namespace
}  // namespace penumbra
