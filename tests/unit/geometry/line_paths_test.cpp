// All paths give the same bits, whatever was asked before, alone or together.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/unit/geometry/random_scenes.h"
#include "worker/geometry/line_fan.h"

namespace penumbra::testing {
namespace {

std::vector<LinePath> vector_paths() {
  std::vector<LinePath> paths{LinePath::kAvx2};
  if (widest_line_path() == LinePath::kAvx512) paths.push_back(LinePath::kAvx512);
  return paths;
}

std::string text(const IntervalSet& set) {
  std::string s;
  for (const Interval& i : set) s += fmt::format("[{:a},{:a}] ", i.lo, i.hi);
  return s;
}

/// No tree at all: every triangle in the order given.
IntervalSet by_every_triangle(const LineBvh& bvh, const TriangleMesh& mesh, const LineQuery& query) {
  IntervalSet visible;
  const Vec3d x(query.x);
  const LineFan fan =
      make_fan(x, Vec3d(query.a) - x, Vec3d(query.b) - x, bvh.world.reach(x), chord_plane(query));
  if (fan.degenerate) return visible;
  visible.reset();
  const Excluded light = excluded_in(bvh, query, kNone);
  for (size_t i = 0; i < mesh.triangles(); ++i) {
    if (light.holds(static_cast<uint32_t>(i))) continue;
    const Vec3f p[3] = {mesh.positions[mesh.indices[3 * i]], mesh.positions[mesh.indices[3 * i + 1]],
                        mesh.positions[mesh.indices[3 * i + 2]]};
    const Interval hidden = hidden_by_triangle(fan, p);
    visible.subtract(hidden.lo, hidden.hi);
  }
  return visible;
}

struct PathCase {
  const char* name;
  TriangleMesh mesh;
  int queries;
};

std::vector<PathCase> path_cases() {
  std::vector<PathCase> cases;
  cases.push_back({"few large", soup(40, 0.5f, 1), 20000});
  cases.push_back({"many small", soup(4000, 0.05f, 2), 4000});
  cases.push_back({"slats", soup(400, 1.f, 3), 4000});
  cases.push_back({"few large pairs", loose_pairs(30, 0.7f, 4), 20000});
  cases.push_back({"many pairs", loose_pairs(2000, 0.1f, 5), 4000});
  cases.push_back({"long pairs", loose_pairs(200, 2.f, 6), 4000});
  cases.push_back({"ball", ball({0, 0, 0}, 0.7f, 24, 0.1f), 8000});
  return cases;
}

TEST(LinePaths, AgreeWithEveryTriangleToTheBit) {
  for (const PathCase& c : path_cases()) {
    const LineBvh bvh = bvh_of({&c.mesh});
    Random random(17);
    for (int i = 0; i < c.queries; ++i) {
      const LineQuery query = random_query(random);
      const IntervalSet expected = by_every_triangle(bvh, c.mesh, query);
      ASSERT_EQ(visible_by(bvh, LinePath::kScalar, query), expected) << c.name << ", query " << i;
      for (const LinePath path : vector_paths()) {
        const IntervalSet got = visible_by(bvh, path, query);
        ASSERT_EQ(got, expected) << c.name << ", query " << i << ", " << name_of(path) << "\n"
                                 << text(got) << "\n"
                                 << text(expected);
      }
    }
  }
}

/// The light may be one triangle of a pair, or end in the middle of one.
TEST(LinePaths, ALightInAPairHidesNothingOfItself) {
  const TriangleMesh mesh = loose_pairs(40, 0.8f, 7);
  const LineBvh bvh = bvh_of({&mesh});
  Random random(23);
  for (int i = 0; i < 10000; ++i) {
    LineQuery query = random_query(random);
    query.light = {kNone, 0, static_cast<uint32_t>(random.uniform(0, 76.999f))};
    query.light_primitives = 1 + static_cast<uint32_t>(random.uniform(0, 2.999f));
    const IntervalSet expected = by_every_triangle(bvh, mesh, query);
    ASSERT_EQ(visible_by(bvh, LinePath::kScalar, query), expected) << "query " << i;
    for (const LinePath path : vector_paths())
      ASSERT_EQ(visible_by(bvh, path, query), expected) << "query " << i;
  }
}

/// Chords in the planes of the triangles, through their vertices and from points on them.
TEST(LinePaths, AgreeInDegeneratePositions) {
  TriangleMesh mesh = ball({0, 0, 0}, 0.7f, 12);
  const LineBvh bvh = bvh_of({&mesh});
  Random random(5);
  const auto vertex = [&] {
    return mesh.positions[static_cast<size_t>(random.uniform(0, 0.999f) * mesh.positions.size())];
  };
  for (int i = 0; i < 10000; ++i) {
    LineQuery query = random_query(random);
    if (random.uniform() < 0.5f) query.a = vertex();
    if (random.uniform() < 0.5f) query.b = vertex();
    if (random.uniform() < 0.3f) query.x = vertex();
    if (random.uniform() < 0.2f) query.x.z = query.a.z = query.b.z = 0;
    // A light's plane through the chord and a vertex: what is in it hides nothing.
    const Vec3d normal = (Vec3d(query.b) - Vec3d(query.a)).cross(Vec3d(vertex()) - Vec3d(query.a));
    if (random.uniform() < 0.5f && normal.length() > 0) query.plane = {normal.normalized(), 0x1p-24};
    const IntervalSet expected = by_every_triangle(bvh, mesh, query);
    ASSERT_EQ(visible_by(bvh, LinePath::kScalar, query), expected) << i;
    for (const LinePath path : vector_paths()) ASSERT_EQ(visible_by(bvh, path, query), expected) << i;
  }
}

TEST(LinePaths, QueriesTogetherAnswerAsAlone) {
  const TriangleMesh mesh = soup(1000, 0.2f, 9);
  const LineBvh bvh = bvh_of({&mesh});
  Random random(3);
  for (int i = 0; i < 500; ++i) {
    std::vector<LineQuery> queries;
    const Vec3f x = random.in_cube();
    for (int k = 0; k < 1 + i % 7; ++k) {
      queries.push_back(random_query(random));
      queries.back().x = x;
    }
    for (const LinePath path : vector_paths()) {
      std::vector<IntervalSet> together;
      QueryCounters counters;
      visible_lines(bvh, path, queries, together, counters);
      ASSERT_EQ(together.size(), queries.size());
      EXPECT_EQ(counters.line_queries, queries.size());
      for (size_t k = 0; k < queries.size(); ++k) ASSERT_EQ(together[k], visible_by(bvh, path, queries[k]));
    }
  }
}

/// 10,000 slats leave thousands of intervals: no buffer has a last entry.
TEST(LinePaths, ThousandsOfIntervals) {
  TriangleMesh mesh;
  const int slats = 5000;
  for (int i = 0; i < slats; ++i) {
    const float u = (static_cast<float>(i) + 0.25f) / slats, w = (static_cast<float>(i) + 0.75f) / slats;
    for (const Vec3f& p : {Vec3f(u, -1, 1), Vec3f(w, -1, 1), Vec3f(w, 1, 1), Vec3f(u, -1, 1), Vec3f(w, 1, 1),
                           Vec3f(u, 1, 1)}) {
      mesh.indices.push_back(static_cast<uint32_t>(mesh.positions.size()));
      mesh.positions.push_back(p);
    }
  }
  const LineBvh bvh = bvh_of({&mesh});
  const LineQuery query{{0.5f, 0, -1000}, {0.f, 0.01f, 2}, {1.f, 0.02f, 2}};
  const IntervalSet expected = by_every_triangle(bvh, mesh, query);
  EXPECT_GT(expected.size(), slats - 10u);
  EXPECT_NEAR(expected.length(), 0.5, 0.01);
  EXPECT_EQ(visible_by(bvh, LinePath::kScalar, query), expected);
  for (const LinePath path : vector_paths()) EXPECT_EQ(visible_by(bvh, path, query), expected);
}

}  // namespace
}  // namespace penumbra::testing
