// Shafts against single queries: the same bits for lines and rays, in scenes where each certificate occurs
// and in positions where roundings decide.
#include "worker/geometry/shaft.h"

#include <gtest/gtest.h>

#include <map>

#include "tests/unit/geometry/random_scenes.h"

namespace penumbra::testing {
namespace {

/// A light and the floats that it is made of.
struct Light {
  Vec3f o, u, v;
  bool triangle = false;
  LightPolygon polygon;
};

Light light_of(const Vec3f& o, const Vec3f& u, const Vec3f& v, bool triangle, PrimitiveId id = {},
               uint32_t primitives = 0) {
  Light light{o, u, v, triangle, {}};
  light.polygon = triangle ? LightPolygon::triangle(o, o + u, o + v, id, primitives)
                           : LightPolygon::quad(o, u, v, id, primitives);
  return light;
}

Light random_light(Random& random, float size) {
  return light_of(random.in_cube(), random.direction() * size, random.direction() * size,
                  random.uniform() < 0.3f);
}

/// Parameters of a point of the light, mostly inside, some on its edges and corners.
Vec2f random_parameters(Random& random, bool triangle) {
  Vec2f p(random.uniform(), random.uniform());
  if (random.uniform() < 0.2f) p.x = random.uniform() < 0.5f ? 0.f : 1.f;
  if (random.uniform() < 0.2f) p.y = random.uniform() < 0.5f ? 0.f : 1.f;
  if (triangle && p.x + p.y > 1) p = Vec2f(1 - p.x, 1 - p.y);
  return p;
}

/// Of the light, computed in double precision and rounded once.
Vec3f point_on(const Light& light, const Vec2f& p) {
  return Vec3f(Vec3d(light.o) + Vec3d(light.u) * double{p.x} + Vec3d(light.v) * double{p.y});
}

/// Counts and failures of many shafts in one scene.
struct Tally {
  std::map<ShaftContent, int> contents;
  int lines = 0, rays = 0;
};

class Comparison {
 public:
  Comparison(const Geometry& geometry, Random& random) : geometry_(geometry), random_(random) {}

  /// One shaft, some chords and points of its light. A chord that ends below the horizon is clipped.
  void compare(const Vec3f& x, const Light& light, const Vec3f& horizon = {0, 0, 0}) {
    geometry_.enter({x, &light.polygon, horizon}, shaft_, counters_);
    ++tally.contents[shaft_.content()];
    EXPECT_EQ(shaft_.listed() > 0, shaft_.content() == ShaftContent::kFew);
    std::vector<LineQuery> queries;
    for (int i = 0; i < 6; ++i) {
      LineQuery query{x,
                      point(light),
                      point(light),
                      light.polygon.light,
                      light.polygon.light_primitives,
                      {light.polygon.normal}};
      if (above(horizon, x, query.a, query.b)) queries.push_back(query);
    }
    std::vector<IntervalSet> alone, together;
    geometry_.visible(queries, alone, counters_);
    geometry_.visible(shaft_, queries, together, counters_);
    ASSERT_EQ(together.size(), queries.size());
    for (size_t i = 0; i < queries.size(); ++i) ASSERT_EQ(together[i], alone[i]) << name() << ", line " << i;
    tally.lines += static_cast<int>(queries.size());
    for (int i = 0; i < 6; ++i) {
      const Vec2f at = random_parameters(random_, light.triangle);
      const LightEnd y{Vec3d(light.o) + Vec3d(light.u) * double{at.x} + Vec3d(light.v) * double{at.y},
                       {light.polygon.normal},
                       light.polygon.light,
                       light.polygon.light_primitives};
      if (horizon != Vec3f(0, 0, 0) && Vec3d(horizon).dot(y.p - Vec3d(x)) < 0) continue;
      ASSERT_EQ(geometry_.occluded(shaft_, x, y, counters_), geometry_.occluded(x, y, counters_)) << name();
      ++tally.rays;
    }
  }

  Tally tally;

 private:
  Vec3f point(const Light& light) { return point_on(light, random_parameters(random_, light.triangle)); }
  std::string name() const {
    constexpr const char* names[] = {"clear", "hidden", "few", "many"};
    return names[static_cast<int>(shaft_.content())];
  }
  /// Clips [a,b] to the horizon; false if nothing is left.
  static bool above(const Vec3f& horizon, const Vec3f& x, Vec3f& a, Vec3f& b) {
    if (horizon == Vec3f(0, 0, 0)) return true;
    const double ha = Vec3d(horizon).dot(Vec3d(a) - Vec3d(x)), hb = Vec3d(horizon).dot(Vec3d(b) - Vec3d(x));
    if (ha <= 0 && hb <= 0) return false;
    const Vec3d from(a), along = Vec3d(b) - from;
    if (ha < 0) a = Vec3f(from + along * (ha / (ha - hb)));
    if (hb < 0) b = Vec3f(from + along * (ha / (ha - hb)));
    return true;
  }

  const Geometry& geometry_;
  Random& random_;
  Shaft shaft_;
  QueryCounters counters_;
};

Geometry geometry_of(const std::vector<const TriangleMesh*>& meshes) {
  std::vector<MeshInput> inputs;
  for (const TriangleMesh* mesh : meshes) inputs.push_back({mesh});
  return *Geometry::build(inputs, {}, {}, 1);
}

TEST(Shaft, AnswersAsSingleQueriesInRandomScenes) {
  struct Case {
    const char* name;
    TriangleMesh mesh;
    float light;
    int shafts;
    std::vector<ShaftContent> expected;
  };
  const std::vector<Case> cases = {
      {"few large",
       soup(12, 1.f, 1),
       0.4f,
       6000,
       {ShaftContent::kClear, ShaftContent::kHidden, ShaftContent::kFew}},
      {"small lights",
       soup(60, 0.6f, 2),
       0.02f,
       6000,
       {ShaftContent::kClear, ShaftContent::kHidden, ShaftContent::kFew}},
      {"many small", soup(4000, 0.05f, 3), 0.3f, 1500, {ShaftContent::kFew, ShaftContent::kMany}},
      {"ball",
       ball({0, 0, 0}, 0.7f, 24, 0.1f),
       0.3f,
       4000,
       {ShaftContent::kClear, ShaftContent::kFew, ShaftContent::kMany}},
  };
  for (const Case& c : cases) {
    SCOPED_TRACE(c.name);
    const Geometry geometry = geometry_of({&c.mesh});
    Random random(23);
    Comparison comparison(geometry, random);
    for (int i = 0; i < c.shafts && !HasFatalFailure(); ++i)
      comparison.compare(random.in_cube(), random_light(random, c.light));
    for (const ShaftContent content : c.expected)
      EXPECT_GT(comparison.tally.contents[content], c.shafts / 50) << static_cast<int>(content);
    EXPECT_EQ(comparison.tally.lines, 6 * c.shafts);
  }
}

/// A room as renderers have it: x on a surface, a few roundings off it, the surface's horizon; everything
/// scaled and moved.
TEST(Shaft, PointsOnSurfacesOfARoom) {
  struct Place {
    float scale;
    Vec3f move;
  };
  for (const Place& place : {Place{1, {0, 0, 0}}, Place{1e-6f, {0, 0, 0}}, Place{1e6f, {0, 0, 0}},
                             Place{1, {1e4f, -3e4f, 2e4f}}}) {
    SCOPED_TRACE(place.scale);
    const auto put = [&](const Vec3f& p) { return p * place.scale + place.move; };
    TriangleMesh room = soup(6, 0.5f, 7);
    const auto quad = [&](const Vec3f& o, const Vec3f& u, const Vec3f& v) {
      const auto first = static_cast<uint32_t>(room.positions.size());
      for (const Vec3f& p : {o, o + u, o + u + v, o + v}) room.positions.push_back(p);
      for (const uint32_t i : {0, 1, 2, 0, 2, 3}) room.indices.push_back(first + i);
    };
    quad({-1, -1, -1}, {2, 0, 0}, {0, 2, 0});
    quad({-1, -1, 1}, {0, 2, 0}, {2, 0, 0});
    quad({-1, -1, -1}, {0, 0, 2}, {2, 0, 0});
    quad({-1, 1, -1}, {2, 0, 0}, {0, 0, 2});
    for (Vec3f& p : room.positions) p = put(p);
    const Geometry geometry = geometry_of({&room});
    Random random(31);
    Comparison comparison(geometry, random);
    for (int i = 0; i < 6000 && !HasFatalFailure(); ++i) {
      // Under the ceiling, touching a wall, in the ceiling's plane, upright on the floor.
      const float h = i % 4 == 2 ? 1.f : i % 4 == 1 ? 0.5f : 0.98f;
      const Vec3f o(i % 4 == 1 ? 0.5f : -0.25f, -0.2f, h), u(0.5f, 0, 0), v(0, -0.4f, 0);
      const Vec3f corner = put(o), first = i % 4 == 3 ? Vec3f(0, 0.4f, 0) : u, second = i % 4 == 3 ? u : v;
      const Light light =
          light_of(corner, put(o + first) - corner, put(o + second) - corner, random.uniform() < 0.3f);
      const float offset = 3e-7f * (1 + random.uniform()) * (place.scale + place.move.length());
      Vec3f x = put({random.uniform(-1, 1), random.uniform(-1, 1), -1});
      x.z += offset;
      Vec3f horizon(0, 0, 1);
      if (i % 5 == 0) {
        x = put({random.uniform(-1, 1), -1, random.uniform(-1, 1)});
        x.y += offset;
        horizon = {0, 1, 0};
      }
      comparison.compare(x, light, horizon);
    }
    EXPECT_GT(comparison.tally.contents[ShaftContent::kClear], 400);
    EXPECT_GT(comparison.tally.contents[ShaftContent::kFew], 200);
  }
}

/// Lights whose edges run through vertices and edges of the mesh, points on it, lights in its planes.
TEST(Shaft, DegeneratePositions) {
  const TriangleMesh mesh = ball({0, 0, 0}, 0.7f, 6);
  const Geometry geometry = geometry_of({&mesh});
  Random random(5);
  const auto vertex = [&] {
    return mesh.positions[static_cast<size_t>(random.uniform(0, 0.999f) * mesh.positions.size())];
  };
  Comparison comparison(geometry, random);
  for (int i = 0; i < 6000 && !HasFatalFailure(); ++i) {
    const Vec3f o = random.uniform() < 0.5f ? vertex() * 1.5f : random.in_cube();
    const Vec3f p = random.uniform() < 0.5f ? vertex() : random.in_cube();
    const Vec3f q = random.uniform() < 0.5f ? vertex() * 1.5f : random.in_cube();
    Vec3f x = random.uniform() < 0.3f ? vertex() : random.in_cube() * 1.5f;
    if (random.uniform() < 0.2f) x.z = 0;
    comparison.compare(x, light_of(o, p - o, q - o, random.uniform() < 0.5f));
  }
}

/// What hid the last point is tried first for the next; whether it is must not show.
TEST(Shaft, DoesNotRememberWrongly) {
  const TriangleMesh mesh = soup(12, 1.f, 1);
  const Geometry geometry = geometry_of({&mesh});
  Random random(3);
  QueryCounters counters;
  Shaft kept;
  int hidden = 0;
  for (int i = 0; i < 4000; ++i) {
    const Light light = random_light(random, 0.3f);
    const Vec3f x = random.in_cube();
    Shaft fresh;
    geometry.enter({x, &light.polygon, {0, 0, 0}}, fresh, counters);
    geometry.enter({x, &light.polygon, {0, 0, 0}}, kept, counters);
    ASSERT_EQ(kept.content(), fresh.content());
    hidden += fresh.content() == ShaftContent::kHidden;
    geometry.enter({x + random.in_cube() * 0.01f, &light.polygon, {0, 0, 0}}, kept, counters);
  }
  EXPECT_GT(hidden, 100);
}

TEST(Shaft, TheLightsOwnTrianglesDoNotHideIt) {
  TriangleMesh light_mesh;
  light_mesh.positions = {{-1, -1, 2}, {-1, 1, 2}, {1, 1, 2}, {1, -1, 2}};
  light_mesh.indices = {0, 1, 2, 0, 2, 3};
  const Geometry geometry = geometry_of({&light_mesh});
  const Light own = light_of({-1, -1, 2}, {0, 2, 0}, {2, 0, 0}, false, {kNone, 0, 0}, 2);
  const Light before = light_of({-0.5f, -0.5f, 2.5f}, {0, 1, 0}, {1, 0, 0}, false, {kNone, 0, 0}, 2);
  const Light foreign = light_of({-0.75f, 0.25f, 2.5f}, {0, 0.25f, 0}, {0.25f, 0, 0}, false);
  QueryCounters counters;
  Shaft shaft;
  const Vec3f x(0.25f, 0.125f, 0);
  for (const Light* light : {&own, &before}) {
    geometry.enter({x, &light->polygon, {0, 0, 1}}, shaft, counters);
    EXPECT_EQ(shaft.content(), ShaftContent::kClear);
  }
  geometry.enter({{-0.5f, 0.25f, 0}, &foreign.polygon, {0, 0, 1}}, shaft, counters);
  EXPECT_EQ(shaft.content(), ShaftContent::kHidden);
}

TEST(Shaft, FromBehindAndFromTheLightsPlaneItTellsNothing) {
  const TriangleMesh mesh = soup(4, 0.1f, 1);
  const Geometry geometry = geometry_of({&mesh});
  const Light light = light_of({-1, -1, 2}, {0, 2, 0}, {2, 0, 0}, false);
  QueryCounters counters;
  Shaft shaft;
  for (const Vec3f& x : {Vec3f(0, 0, 3), Vec3f(5, 0, 2), Vec3f(0, 0, 2)}) {
    geometry.enter({x, &light.polygon, {0, 0, 0}}, shaft, counters);
    EXPECT_EQ(shaft.content(), ShaftContent::kMany);
  }
}

/// Alpha-tested meshes are in no list and yet hide from rays; placed objects are not looked into.
TEST(Shaft, AlphaAndInstances) {
  TriangleMesh world = soup(2, 0.1f, 1), part = ball({0, 0, 0}, 0.3f, 8);
  TriangleMesh leaf;
  leaf.positions = {{-5, -5, 0.5f}, {5, -5, 0.5f}, {0, 5, 0.5f}};
  leaf.indices = {0, 1, 2};
  const AlphaTest alpha = [](uint32_t, float u, float) { return u < 0.5f; };
  Matrix placed;
  placed[3][0] = 0.2f, placed[3][2] = 1;
  const std::vector<MeshInput> inputs = {{&world}, {&leaf, alpha}, {&part}};
  const ObjectInput object{2, 3};
  const InstanceInput instance{0, placed};
  const Geometry geometry = *Geometry::build(inputs, {&object, 1}, {&instance, 1}, 1);
  Random random(2);
  Comparison comparison(geometry, random);
  for (int i = 0; i < 2000 && !HasFatalFailure(); ++i) {
    const Vec3f o = random.in_cube() + Vec3f(0, 0, 3);
    comparison.compare(random.in_cube() - Vec3f(0, 0, 2),
                       light_of(o, {0, 0.4f, 0}, {0.4f, 0, 0}, i % 2 == 0));
  }
  EXPECT_GT(comparison.tally.contents[ShaftContent::kClear], 200);
  EXPECT_GT(comparison.tally.contents[ShaftContent::kMany], 50);
}

}  // namespace
}  // namespace penumbra::testing
