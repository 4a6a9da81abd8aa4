// Shadow segments that end on a flat light: covers a few units of the last place before it hide it, what lies
// in its plane or behind it does not, and of its own surface only what is named.
#include <gtest/gtest.h>

#include <random>

#include "worker/geometry/geometry.h"

namespace penumbra {
namespace {

/// A quad and where it stands; the light and its cover are of one frame.
struct Frame {
  Vec3d o, u, v, n;
  static Frame random(std::mt19937& engine, double away) {
    std::normal_distribution<double> normal;
    const auto direction = [&] { return Vec3d(normal(engine), normal(engine), normal(engine)).normalized(); };
    Frame f;
    f.n = direction();
    f.u = direction().cross(f.n).normalized();
    f.v = f.n.cross(f.u);
    f.o = direction() * away;
    return f;
  }
  /// [u0,u1] × [v0,v1], `before` the frame's plane on the side of n.
  TriangleMesh quad(double u0, double u1, double v0, double v1, double before) const {
    TriangleMesh mesh;
    const double at[4][2] = {{u0, v0}, {u0, v1}, {u1, v1}, {u1, v0}};
    for (const auto& c : at) mesh.positions.emplace_back(o + u * c[0] + v * c[1] + n * before);
    mesh.indices = {0, 1, 2, 0, 2, 3};
    return mesh;
  }
};

Geometry geometry_of(const std::vector<MeshInput>& inputs, const std::vector<ObjectInput>& objects = {},
                     const std::vector<InstanceInput>& instances = {}) {
  auto geometry = Geometry::build(inputs, objects, instances, 1);
  EXPECT_TRUE(geometry.ok());
  return std::move(*geometry);
}

/// A point of the light, which is mesh 0.
LightEnd end_on(const Geometry& geometry, const Frame& f, const Vec3d& p) {
  const PrimitiveId id{kNone, 0, 0};
  return {p, {f.n, geometry.place_of(id, 2, f.n).rounding}, id, 2};
}

/// Of `rays` segments from points before the light to points of it, how many are hidden. The light is mesh 0.
int hidden(const Geometry& geometry, const Frame& f, std::mt19937& engine, int rays) {
  std::uniform_real_distribution<double> uniform(0, 1);
  QueryCounters counters;
  int count = 0;
  for (int i = 0; i < rays; ++i) {
    const double height = i % 3 == 0 ? 0.01 : 1.5;
    const Vec3f x(f.o + f.u * (4 * uniform(engine) - 2) + f.v * (4 * uniform(engine) - 2) +
                  f.n * height * (0.5 + uniform(engine)));
    const LightEnd end = end_on(geometry, f, f.o + f.u * uniform(engine) + f.v * uniform(engine));
    count += geometry.occluded(x, end, counters);
  }
  return count;
}

/// Of `lines` chords of the light from points before it, the mean visible part.
double seen_by_lines(const Geometry& geometry, const Frame& f, std::mt19937& engine, int lines) {
  std::uniform_real_distribution<double> uniform(0, 1);
  const PrimitiveId id{kNone, 0, 0};
  const LightPlane plane{f.n, geometry.place_of(id, 2, f.n).rounding};
  QueryCounters counters;
  std::vector<IntervalSet> visible;
  double sum = 0;
  for (int i = 0; i < lines; ++i) {
    const double height = i % 3 == 0 ? 0.01 : 1.5;
    const Vec3f x(f.o + f.u * (4 * uniform(engine) - 2) + f.v * (4 * uniform(engine) - 2) +
                  f.n * height * (0.5 + uniform(engine)));
    const auto on_light = [&] { return Vec3f(f.o + f.u * uniform(engine) + f.v * uniform(engine)); };
    const LineQuery query{x, on_light(), on_light(), id, 2, plane};
    geometry.visible({&query, 1}, visible, counters);
    sum += visible[0].length();
  }
  return sum / lines;
}

constexpr int kRays = 300;
constexpr double kRoundoff = 0x1p-24;

TEST(LightEnd, WhatIsBeforeItHidesItAndWhatIsInItsPlaneOrBehindDoesNot) {
  std::mt19937 engine(1);
  for (const double away : {0.0, 2.0, 50.0})
    for (int i = 0; i < 20; ++i) {
      const Frame f = Frame::random(engine, away);
      const double step = 8 * kRoundoff * (away + 3);
      const TriangleMesh light = f.quad(0, 1, 0, 1, 0);
      for (const double before : {step, 4 * step, 0.0, -step, -4 * step}) {
        const TriangleMesh cover = f.quad(-1, 2, -1.5, 1.5, before);
        const Geometry geometry = geometry_of({{&light}, {&cover}});
        EXPECT_EQ(hidden(geometry, f, engine, kRays), before > 0 ? kRays : 0)
            << "away " << away << ", before " << before;
      }
    }
}

TEST(LightEnd, LinesSeeCoversAsRaysDo) {
  std::mt19937 engine(6);
  for (const double away : {0.0, 2.0, 50.0})
    for (const double size : {1.5, 30.0, 1000.0})
      for (int i = 0; i < 20; ++i) {
        const Frame f = Frame::random(engine, away);
        const double step = 8 * kRoundoff * (away + 2 * size);
        const TriangleMesh light = f.quad(0, 1, 0, 1, 0);
        for (const double before : {step, 4 * step, 0.0, -step, -4 * step}) {
          const TriangleMesh cover = f.quad(-size, size + 1, -size, size, before);
          const Geometry geometry = geometry_of({{&light}, {&cover}});
          EXPECT_EQ(seen_by_lines(geometry, f, engine, kRays), before > 0 ? 0 : 1)
              << "away " << away << ", size " << size << ", before " << before;
          EXPECT_EQ(hidden(geometry, f, engine, kRays), before > 0 ? kRays : 0)
              << "away " << away << ", size " << size << ", before " << before;
        }
      }
}

TEST(LightEnd, AxisAlignedCoversCountFromTwoUnitsOfTheLastPlace) {
  Frame f;
  f.o = {-0.5, 2.2f, -0.5}, f.u = {1, 0, 0}, f.v = {0, 0, 1}, f.n = {0, -1, 0};
  const double unit = 0x1p-22;  // of the height
  std::mt19937 engine(2);
  const TriangleMesh light = f.quad(0, 1, 0, 1, 0);
  for (int units = -3; units <= 4; ++units) {
    if (units == 1) continue;  // the rounding of one vertex against another
    const TriangleMesh cover = f.quad(-1, 2, -1, 2, units * unit);
    const Geometry geometry = geometry_of({{&light}, {&cover}});
    EXPECT_EQ(hidden(geometry, f, engine, kRays), units > 1 ? kRays : 0) << units;
  }
}

TEST(LightEnd, InstancesAndAlphaAreJudgedAlike) {
  std::mt19937 engine(3);
  for (const double before : {64 * kRoundoff * 5, 0.0}) {
    const Frame f = Frame::random(engine, 2);
    const TriangleMesh light = f.quad(0, 1, 0, 1, 0);
    Frame object = f;
    object.o -= Vec3d(1, 2, 3);
    const TriangleMesh placed = object.quad(-1, 2, -1.5, 1.5, before),
                       cover = f.quad(-1, 2, -1.5, 1.5, before);
    Matrix to_world;
    to_world.translate(Vec3d(1, 2, 3));
    const Geometry instanced = geometry_of({{&light}, {&placed}}, {{1, 2}}, {{0, to_world}});
    EXPECT_EQ(hidden(instanced, f, engine, kRays), before > 0 ? kRays : 0);
    QueryCounters counters;
    const LightEnd end = end_on(instanced, f, f.o + f.u * 0.5 + f.v * 0.5);
    const Vec3f x(f.o + f.n);
    for (const bool solid : {true, false}) {
      const AlphaTest alpha = [=](uint32_t, float, float) { return solid; };
      const Geometry tested = geometry_of({{&light}, {&cover, alpha}});
      EXPECT_EQ(tested.occluded(x, end, counters), solid && before > 0);
      EXPECT_EQ(tested.occluded_by_alpha(x, end, counters), solid && before > 0);
    }
  }
}

/// Each triangle of a tetrahedron is a light of its own: its far sides are hidden by the near ones.
TEST(LightEnd, AClosedLightHidesItsFarSide) {
  TriangleMesh mesh;
  mesh.positions = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
  mesh.indices = {0, 1, 2, 0, 2, 3, 0, 3, 1, 1, 3, 2};
  const Geometry geometry = geometry_of({{&mesh}});
  std::mt19937 engine(4);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(0, 1);
  QueryCounters counters;
  for (int i = 0; i < 2000; ++i) {
    const Vec3f x(Vec3d(normal(engine), normal(engine), normal(engine)).normalized() * 4);
    const auto triangle = uint32_t(i % 4);
    Vec3d p[3];
    for (int c = 0; c < 3; ++c) p[c] = Vec3d(mesh.positions[mesh.indices[3 * triangle + uint32_t(c)]]);
    const Vec3d n = (p[1] - p[0]).cross(p[2] - p[0]).normalized();
    const double side = n.dot(p[0]) < 0 ? -1 : 1;  // the centre is the origin
    const double a = std::sqrt(uniform(engine)), b = uniform(engine);
    const Vec3d at = p[0] * (1 - a) + p[1] * (a * (1 - b)) + p[2] * (a * b);
    const PrimitiveId id{kNone, 0, triangle};
    const double rounding = geometry.place_of(id, 1, n).rounding;
    const bool faces = side * n.dot(Vec3d(x) - at) > 0;
    EXPECT_EQ(geometry.occluded(x, {at, {n, rounding}, id, 1}, counters), !faces);
  }
}

/// A light that has nothing close to it needs no judging; the answers are the same.
/// A lip beside a light hides it from low places as lines see it, however shallow the rays come.
TEST(LightEnd, ALipBesideItHidesItFromLowPlaces) {
  const Frame f{{0, 0, 0}, {0, 2, 0}, {0.1, 0, 0}, {0, 0, -1}};
  const TriangleMesh light = f.quad(0, 1, 0, 1, 0);
  TriangleMesh lip;  // 0.0004 beside the edge v = 0, from the light's plane down
  for (const Vec3f& p : {Vec3f(-0.0004f, -1, 0), Vec3f(-0.0004f, 3, 0), Vec3f(-0.0004f, 3, -0.004f),
                         Vec3f(-0.0004f, -1, -0.004f)})
    lip.positions.push_back(p);
  lip.indices = {0, 1, 2, 0, 2, 3};
  TriangleMesh floor;  // the scene is as large as the rays are long
  floor.positions = {{-12, -5, -5}, {12, -5, -5}, {0, 5, -5}};
  floor.indices = {0, 1, 2};
  const Geometry geometry = geometry_of({{&light}, {&lip}, {&floor}});
  const PrimitiveId id{kNone, 0, 0};
  const LightPlace place = geometry.place_of(id, 2, f.n);
  QueryCounters counters;
  int seen = 0, rays = 0;
  for (int i = 0; i < 100; ++i)
    for (int k = 0; k < 100; ++k) {
      // Below the straight line from the light's far edge over the lip's: nothing of the light is seen.
      const Vec3f x(-10, 0.5f + 0.01f * float(i), -0.1f);
      const Vec3d p = f.o + f.u * ((k + 0.5) / 100) + f.v * ((k * 37 % 100 + 0.5) / 100);
      seen += !geometry.occluded(x, {p, {f.n, place.rounding}, id, 2, place.crowded}, counters);
      ++rays;
    }
  EXPECT_EQ(seen, 0) << "of " << rays << (place.crowded ? ", crowded" : "");
}

TEST(LightEnd, CrowdedIsWhatHasSomethingClose) {
  std::mt19937 engine(5);
  const Frame f{{-0.5, 2, -0.5}, {1, 0, 0}, {0, 0, 1}, {0, -1, 0}};
  const TriangleMesh light = f.quad(0, 1, 0, 1, 0), floor = f.quad(-2, 3, -2, 3, 2);
  const PrimitiveId id{kNone, 0, 0};
  for (const double before : {0.5, 1e-2, 1e-3, 1e-6, 0.0, -1e-6, -1e-3, -0.1}) {
    const TriangleMesh cover = f.quad(0.25, 0.75, 0.25, 0.75, before);
    const Geometry geometry = geometry_of({{&light}, {&floor}, {&cover}});
    const bool crowded = geometry.place_of(id, 2, f.n).crowded;
    EXPECT_EQ(crowded, std::abs(before) < 5e-4) << before;
    QueryCounters counters;
    std::uniform_real_distribution<double> uniform(-0.4, 1.4);
    for (int i = 0; i < kRays; ++i) {
      const Vec3f x(f.o + f.u * uniform(engine) + f.v * uniform(engine) + f.n * 1.9);
      LightEnd end = end_on(geometry, f, f.o + f.u * 0.5 + f.v * 0.5);
      const bool judged = geometry.occluded(x, end, counters);
      end.crowded = crowded;
      EXPECT_EQ(geometry.occluded(x, end, counters), judged) << before;
    }
  }
}

}  // namespace
}  // namespace penumbra
