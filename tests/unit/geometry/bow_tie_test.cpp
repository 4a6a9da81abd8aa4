// What a chord sees through a point, interval by interval, against Embree's rays.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/geometry/random_scenes.h"

namespace penumbra::testing {
namespace {

Geometry geometry_of(const std::vector<TriangleMesh>& meshes, const std::vector<ObjectInput>& objects = {},
                     const std::vector<InstanceInput>& instances = {}) {
  std::vector<MeshInput> inputs;
  for (const TriangleMesh& mesh : meshes) inputs.push_back({&mesh, {}, true});
  return Geometry::build(inputs, objects, instances, 2).value();
}

PrimitiveId ray_from(const Geometry& geometry, const FocusedChord& chord, double v) {
  const Vec3f from(chord.a + (chord.b - chord.a) * v);
  const Vec3f direction((chord.focus - Vec3d(from)).normalized());
  QueryCounters counters;
  const auto hit = geometry.intersect({from, direction, 0, std::numeric_limits<float>::infinity()}, counters);
  return hit ? hit->id : PrimitiveId{};
}

void expect_cover(const std::vector<SeenInterval>& seen) {
  ASSERT_FALSE(seen.empty());
  EXPECT_EQ(seen.front().lo, 0);
  EXPECT_EQ(seen.back().hi, 1);
  for (size_t i = 0; i < seen.size(); ++i) {
    EXPECT_LT(seen[i].lo, seen[i].hi);
    if (i > 0) {
      EXPECT_EQ(seen[i].lo, seen[i - 1].hi);
    }
  }
}

/// Random points of the chord: what the interval says against what the ray meets. A ray's own roundings may
/// decide otherwise within some 1e-5 of an interval's end, so a few of `rays` may differ.
struct Score {
  int rays = 0, different = 0, intervals = 0;

  void add(const Geometry& geometry, const FocusedChord& chord, Random& random, int points) {
    std::vector<SeenInterval> seen;
    QueryCounters counters;
    geometry.nearest(chord, seen, counters);
    EXPECT_EQ(counters.line_queries, 1u);
    expect_cover(seen);
    intervals += int(seen.size());
    for (int k = 0; k < points; ++k) {
      const double v = double(random.uniform());
      size_t i = 0;
      while (seen[i].hi < v) ++i;
      ++rays;
      different += ray_from(geometry, chord, v) != seen[i].id;
    }
  }
};

FocusedChord random_chord(Random& random, float lens, float distance) {
  const Vec3f at = random.direction() * 2.5f;
  return {Vec3d(at + random.in_cube() * lens), Vec3d(at + random.in_cube() * lens),
          Vec3d(at + (random.in_cube() * 0.8f - at).normalized() * distance)};
}

TEST(BowTie, SeesWhatRaysMeet) {
  const std::vector<std::vector<TriangleMesh>> scenes = {
      {soup(40, 0.8f, 1)}, {soup(3000, 0.15f, 2)}, {ball({0, 0, 0}, 1, 40, 0.1f), soup(300, 0.4f, 3)}};
  for (const auto& meshes : scenes) {
    const Geometry geometry = geometry_of(meshes);
    Random random(7);
    Score score;
    for (const float lens : {0.01f, 0.3f, 2.0f})
      for (const float distance : {0.7f, 2.0f, 2.5f, 30.0f})
        for (int i = 0; i < 60; ++i) score.add(geometry, random_chord(random, lens, distance), random, 16);
    EXPECT_LE(score.different, score.rays / 2000) << score.rays;
    EXPECT_GT(score.intervals, 720 * 2);
  }
}

TEST(BowTie, SeesPlacedObjects) {
  Random random(9);
  std::vector<InstanceInput> instances;
  for (int i = 0; i < 12; ++i) {
    Matrix m;
    m.setAxisAngle(Vec3d(random.direction()), 3.0 * double(random.uniform()));
    m = Matrix().setScale(Vec3d(0.5, 0.7, i % 2 ? 0.4 : -0.4)) * m *
        Matrix().setTranslation(Vec3d(random.in_cube()));
    instances.push_back({0, m});
  }
  const std::vector<TriangleMesh> meshes = {soup(60, 0.5f, 4), soup(60, 0.3f, 5)};
  const Geometry geometry = geometry_of(meshes, {{0, 1}}, instances);
  Score score;
  for (int i = 0; i < 400; ++i) score.add(geometry, random_chord(random, 0.3f, 2.0f), random, 16);
  EXPECT_LE(score.different, score.rays / 1000);
}

/// The focus in a surface: every ray meets that at the focus, whichever way roundings fall.
TEST(BowTie, AFocusInASurfaceSeesItEverywhere) {
  TriangleMesh wall;
  wall.positions = {{-2, -2, 0.1f}, {2, -2, 0.1f}, {2, 2, 0.3f}, {-2, 2, 0.3f}};
  wall.indices = {0, 1, 2, 0, 2, 3};
  const std::vector<TriangleMesh> meshes = {wall};
  const Geometry geometry = geometry_of(meshes);
  Random random(3);
  for (int i = 0; i < 500; ++i) {
    // On one of the triangles, to within a rounding of single or double precision.
    const double b1 = 0.05 + 0.4 * double(random.uniform()), b2 = 0.05 + 0.4 * double(random.uniform());
    Vec3d focus = Vec3d(wall.positions[0]) * (1 - b1 - b2) + Vec3d(wall.positions[1]) * b1 +
                  Vec3d(wall.positions[2]) * b2;
    if (i % 2) focus = Vec3d(Vec3f(focus));
    std::vector<SeenInterval> seen;
    QueryCounters counters;
    const Vec3f at(0, 0, 3);
    geometry.nearest({Vec3d(at + random.in_cube() * 0.3f), Vec3d(at + random.in_cube() * 0.3f), focus}, seen,
                     counters);
    expect_cover(seen);
    double covered = 0;
    for (const SeenInterval& s : seen)
      if (s.id.mesh == 0) covered += s.hi - s.lo;
    EXPECT_NEAR(covered, 1, 1e-9) << i;
  }
}

TEST(BowTie, DegenerateChordsAreOneIntervalOfNothing) {
  const std::vector<TriangleMesh> meshes = {soup(40, 0.8f, 1)};
  const Geometry geometry = geometry_of(meshes);
  const FocusedChord degenerate[] = {{{0, 0, 3}, {0, 0, 3}, {0, 0, 1}},       // no chord
                                     {{0, 0, 3}, {0, 0, 2}, {0, 0, 1}},       // seen end on
                                     {{0, 0, 3}, {1, 0, 3}, {0, 0, 3}},       // the focus on the chord
                                     {{0, 0, 3}, {1, 0, 3}, {0, 0, 1e200}}};  // too far to compute with
  for (const FocusedChord& chord : degenerate) {
    std::vector<SeenInterval> seen;
    QueryCounters counters;
    geometry.nearest(chord, seen, counters);
    ASSERT_EQ(seen.size(), 1u);
    EXPECT_EQ(seen[0].id, PrimitiveId{});
    expect_cover(seen);
  }
}

/// Vertices and edges in the plane of the bow-tie, through the focus and through the chord.
TEST(BowTie, TouchingTheLatticeStaysCovered) {
  Random random(11);
  TriangleMesh mesh;
  for (int i = 0; i < 600; ++i) {
    mesh.indices.push_back(uint32_t(i));
    mesh.positions.push_back({std::round(random.uniform(-2, 2)), std::round(random.uniform(-2, 2)),
                              std::round(random.uniform(-2, 2))});
  }
  const std::vector<TriangleMesh> meshes = {mesh};
  const Geometry geometry = geometry_of(meshes);
  std::vector<SeenInterval> seen;
  QueryCounters counters;
  for (int i = 0; i < 3000; ++i) {
    const auto corner = [&] {
      return Vec3d(std::round(random.uniform(-3, 3)), std::round(random.uniform(-3, 3)),
                   std::round(random.uniform(-3, 3)));
    };
    geometry.nearest({corner(), corner(), corner()}, seen, counters);
    expect_cover(seen);
  }
}

/// Two walls that cross: each is seen up to where they do, as computed by hand.
TEST(BowTie, CrossingSurfacesAreCutWhereTheyCross) {
  TriangleMesh x;
  x.positions = {{-4, -9, -1}, {4, -9, 1}, {0, 9, 0}, {-4, -9, 1}, {4, -9, -1}, {0, 9, 0}};
  x.indices = {0, 1, 2, 3, 4, 5};
  const std::vector<TriangleMesh> meshes = {x};
  const Geometry geometry = geometry_of(meshes);
  std::vector<SeenInterval> seen;
  QueryCounters counters;
  // Seen from z = 4 through a focus at z = -4: at z = 0 the rays are at half of (x of the chord).
  geometry.nearest({{-1, 0, 4}, {3, 0, 4}, {0, 0, -4}}, seen, counters);
  ASSERT_EQ(seen.size(), 2u);
  EXPECT_NEAR(seen[0].hi, 0.25, 1e-12);
  EXPECT_EQ(seen[0].id.primitive, 1u);
  EXPECT_EQ(seen[1].id.primitive, 0u);
}

}  // namespace
}  // namespace penumbra::testing
