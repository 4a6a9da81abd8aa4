// Line queries against other roads to the same answer: every triangle in extended precision, rays, closed
// surfaces, moved and scaled scenes.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "tests/unit/geometry/random_scenes.h"

namespace penumbra::testing {
namespace {

using Vec3l = Imath::Vec3<long double>;
using Spans = std::vector<std::pair<long double, long double>>;

/// What a triangle hides of a→b seen from x (all relative to x): its cut with the fan's plane in the
/// coordinates q = s a + r b, by Cramer's rule, clipped to 0 < s+r < 1.
void add_hidden(const Vec3l& a, const Vec3l& b, const Vec3l p[3], Spans& hidden) {
  const Vec3l n = a.cross(b);
  std::vector<std::pair<long double, long double>> cut;  // (t, r)
  for (int i = 0; i < 3; ++i) {
    const Vec3l &from = p[i], &to = p[(i + 1) % 3];
    const long double g0 = n.dot(from), g1 = n.dot(to);
    if ((g0 < 0) == (g1 < 0)) continue;
    const Vec3l q = from + (to - from) * (g0 / (g0 - g1));
    const long double s = n.dot(q.cross(b)) / n.dot(n), r = n.dot(a.cross(q)) / n.dot(n);
    cut.emplace_back(s + r, r);
  }
  if (cut.size() != 2) return;
  auto [t0, r0] = cut[0];
  auto [t1, r1] = cut[1];
  if (t0 > t1) std::swap(t0, t1), std::swap(r0, r1);
  if (t1 <= 0 || t0 >= 1) return;
  const auto r_at = [&](long double t) { return r0 + (r1 - r0) * (t - t0) / (t1 - t0); };
  const long double end = t1 > 1 ? r_at(1) : r1 / t1;
  long double start;
  if (t0 > 0) {
    start = r0 / t0;
  } else {
    start = std::copysign(std::numeric_limits<long double>::infinity(), r_at(0));
  }
  hidden.emplace_back(std::min(start, end), std::max(start, end));
}

/// Visible length by every triangle in extended precision.
long double reference_length(const TriangleMesh& mesh, const LineQuery& query) {
  const Vec3l x(query.x), a = Vec3l(query.a) - x, b = Vec3l(query.b) - x;
  Spans hidden;
  for (size_t i = 0; i < mesh.triangles(); ++i) {
    Vec3l p[3];
    for (int c = 0; c < 3; ++c) p[c] = Vec3l(mesh.positions[mesh.indices[3 * i + c]]) - x;
    add_hidden(a, b, p, hidden);
  }
  std::sort(hidden.begin(), hidden.end());
  long double visible = 0, at = 0;
  for (const auto& [lo, hi] : hidden) {
    if (lo > at) visible += std::min(lo, 1.0L) - at;
    at = std::max(at, hi);
    if (at >= 1) return visible;
  }
  return visible + (1 - at);
}

TEST(LineQuery, MatchesEveryTriangleInExtendedPrecision) {
  constexpr int kQueries = 10000;
  for (uint32_t seed = 1; seed <= 5; ++seed) {
    const TriangleMesh mesh = soup(20 << seed, 1.f / static_cast<float>(seed), seed);
    const LineBvh bvh = bvh_of({&mesh});
    Random random(seed + 100);
    long double sum = 0;
    int far_off = 0;
    for (int i = 0; i < kQueries; ++i) {
      const LineQuery query = random_query(random);
      const long double error =
          std::abs(visible_by(bvh, widest_line_path(), query).length() - reference_length(mesh, query));
      sum += error;
      // Chords seen nearly end on and grazing edges magnify single precision's 2^-24.
      far_off += error > 1e-4L;
      ASSERT_LT(error, 0.05L) << seed << " " << i;
    }
    EXPECT_LT(sum / kQueries, 1e-6L) << seed;
    EXPECT_LT(far_off, kQueries / 1000) << seed;
  }
}

TEST(LineQuery, NothingLeaksFromAClosedSurface) {
  Random random(2);
  for (const int rings : {3, 8, 40}) {
    const TriangleMesh mesh = ball({0.3f, -0.2f, 0.1f}, 1, rings, 0.05f);
    const LineBvh bvh = bvh_of({&mesh});
    for (int i = 0; i < 20000; ++i) {
      LineQuery query = random_query(random);
      query.x = Vec3f(0.3f, -0.2f, 0.1f) + query.x * 0.4f;
      query.a += random.direction() * 4;
      query.b = query.a + random.direction();  // stays outside
      const IntervalSet visible = visible_by(bvh, widest_line_path(), query);
      ASSERT_TRUE(visible.empty()) << rings << " " << i << ": leaks " << visible.length();
    }
  }
}

TEST(LineQuery, AConvexBodyHidesOneInterval) {
  const TriangleMesh mesh = ball({0, 0, 0}, 0.5f, 64);
  const LineBvh bvh = bvh_of({&mesh});
  Random random(4);
  int partly = 0;
  for (int i = 0; i < 20000; ++i) {
    LineQuery query = random_query(random);
    query.x = query.x.normalized() * 2;
    query.a = -query.x + query.a;
    query.b = -query.x + query.b;
    const IntervalSet visible = visible_by(bvh, widest_line_path(), query);
    // Hidden is one interval: two visible ones at most, which then reach to the chord's ends.
    ASSERT_LE(visible.size(), 2u) << i;
    if (visible.size() == 2) {
      ++partly;
      EXPECT_EQ(visible[0].lo, 0);
      EXPECT_EQ(visible[1].hi, 1);
    }
  }
  EXPECT_GT(partly, 500);
}

TEST(LineQuery, VisibleFractionMatchesRays) {
  constexpr int kRays = 4096;
  const TriangleMesh mesh = soup(300, 0.3f, 6);
  const MeshInput input{&mesh};
  const auto geometry = Geometry::build({&input, 1}, {}, {}, 2);
  ASSERT_TRUE(geometry.ok());
  Random random(7);
  QueryCounters counters;
  for (int i = 0; i < 200; ++i) {
    const LineQuery query = random_query(random);
    std::vector<IntervalSet> visible;
    geometry->visible({&query, 1}, visible, counters);
    int lit = 0, changes = 0;
    bool before = true;
    for (int k = 0; k < kRays; ++k) {
      const float v = (static_cast<float>(k) + 0.5f) / kRays;
      const bool now = !geometry->occluded(query.x, query.a + (query.b - query.a) * v, counters);
      lit += now;
      changes += k > 0 && now != before;
      before = now;
    }
    // Each change falls somewhere within its cell; slits between two rays may be missed.
    const double tolerance = (changes + 1) * 0.5 / kRays + 1.0 / kRays;
    EXPECT_NEAR(visible[0].length(), static_cast<double>(lit) / kRays, tolerance) << i;
  }
}

/// A floor just under x, as every shading point has one.
TEST(LineQuery, TheSurfaceBelowXHidesNothing) {
  TriangleMesh floor;
  const int cells = 2;  // large triangles: errors grow with them, the distance to x does not
  for (int i = 0; i <= cells; ++i) {
    for (int k = 0; k <= cells; ++k) floor.positions.push_back(Vec3f(i - 1.f, k - 1.f, 0) * 7.f);
  }
  for (uint32_t i = 0; i < cells; ++i) {
    for (uint32_t k = 0; k < cells; ++k) {
      const uint32_t o = i * (cells + 1) + k;
      floor.indices.insert(floor.indices.end(), {o, o + cells + 1, o + cells + 2, o, o + cells + 2, o + 1});
    }
  }
  Random random(12);
  const LineBvh bvh = bvh_of({&floor});
  for (int i = 0; i < 20000; ++i) {
    // The floor is exact, so x may be as close as it likes: far below single precision's error out there.
    // The chord runs parallel to the floor: t is a rounding away from 0 all along the cut.
    const Vec3f along(random.uniform(-1, 1), random.uniform(), 0);
    LineQuery query;
    query.x = {random.uniform(-5, 5), random.uniform(-5, 5), 1e-9f};
    query.a = {random.uniform(-5, 5), random.uniform(-5, 5), 3};
    query.b = query.a + along;
    const IntervalSet visible = visible_by(bvh, widest_line_path(), query);
    ASSERT_EQ(visible.size(), 1u) << i;
    ASSERT_EQ(visible[0], (Interval{0, 1})) << i;
  }
}

/// Powers of two change no bit; other scales and far-off origins only what rounding must.
TEST(LineQuery, ScaledAndMovedScenesAnswerAlike) {
  // On a grid of 1/8, so that moving by 2^20 is exact.
  TriangleMesh mesh = soup(200, 0.4f, 21);
  const auto snap = [](Vec3f p) {
    for (int k = 0; k < 3; ++k) p[k] = std::round(p[k] * 800) / 8;
    return p;
  };
  for (Vec3f& p : mesh.positions) p = snap(p);
  const LineBvh bvh = bvh_of({&mesh});
  struct Change {
    float scale;
    Vec3f move;
    double tolerance;
  };
  const float far = 1 << 20;
  const Change changes[] = {{0x1p-20f, {0, 0, 0}, 0},
                            {0x1p20f, {0, 0, 0}, 0},
                            {1e-6f, {0, 0, 0}, 1e-6},
                            {1e6f, {0, 0, 0}, 1e-6},
                            {1, {far, -far, far}, 1e-7}};
  for (const Change& change : changes) {
    const auto changed = [&](const Vec3f& p) { return p * change.scale + change.move; };
    TriangleMesh other = mesh;
    for (Vec3f& p : other.positions) p = changed(p);
    const LineBvh other_bvh = bvh_of({&other});
    Random random(22);
    double sum = 0;
    for (int i = 0; i < 3000; ++i) {
      LineQuery query = random_query(random);
      query = {snap(query.x), snap(query.a), snap(query.b)};
      const LineQuery moved{changed(query.x), changed(query.a), changed(query.b)};
      const IntervalSet here = visible_by(bvh, widest_line_path(), query);
      const IntervalSet there = visible_by(other_bvh, widest_line_path(), moved);
      if (change.tolerance == 0) {
        ASSERT_EQ(here, there) << change.scale << " " << i;
      }
      sum += std::abs(here.length() - there.length());
    }
    EXPECT_LE(sum / 3000, change.tolerance) << change.scale << " " << change.move.x;
  }
}

TEST(LineQuery, DegenerateChordsSeeNothing) {
  const TriangleMesh mesh = soup(20, 0.3f, 1);
  const LineBvh bvh = bvh_of({&mesh});
  for (const LinePath path : {LinePath::kScalar, LinePath::kAvx2}) {
    EXPECT_TRUE(visible_by(bvh, path, {{0, 0, 0}, {1, 1, 1}, {1, 1, 1}}).empty());
    EXPECT_TRUE(visible_by(bvh, path, {{0, 0, 0}, {1, 1, 1}, {2, 2, 2}}).empty());
    EXPECT_TRUE(visible_by(bvh, path, {{0, 0, 0}, {0, 0, 0}, {2, 2, 2}}).empty());
  }
}

}  // namespace
}  // namespace penumbra::testing
