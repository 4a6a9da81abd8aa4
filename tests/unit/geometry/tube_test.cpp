// Tubes: what a fan loses by them against a search that knows nothing of fans, every path alike, and rays and
// lines on one surface.
#include "worker/geometry/tube.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/unit/geometry/random_scenes.h"
#include "worker/geometry/shaft.h"

namespace penumbra::testing {
namespace {

using Imath::V4f;

struct Case {
  V4f p[2];
  Vec3d x, a, b;  ///< a, b absolute
};

Case random_case(Random& random) {
  Case c;
  const float thick = std::pow(10.f, random.uniform(-4, -0.3f));
  const Vec3f p0 = random.in_cube(),
              p1 = random.uniform() < 0.3f ? p0 + random.in_cube() * 0.1f : random.in_cube();
  c.p[0] = V4f(p0.x, p0.y, p0.z, thick * random.uniform());
  c.p[1] = V4f(p1.x, p1.y, p1.z, random.uniform() < 0.3f ? c.p[0].w : thick * random.uniform());
  c.x = Vec3d(random.in_cube());
  // A chord about something that the tube may hide.
  const Vec3d at = Vec3d(p0) + (Vec3d(p1) - Vec3d(p0)) * double{random.uniform()};
  const Vec3d end = c.x + (at - c.x) * double{random.uniform(0.7f, 3.f)};
  const Vec3d along = Vec3d(random.direction()) * double{random.uniform(0.1f, 2.f)};
  c.a = end - along * double{random.uniform()};
  c.b = c.a + along;
  return c;
}

/// How far the segment from x to P(v) keeps from the tube; negative: it meets it. Convex in w, so ternary
/// search.
double clearance(const Case& c, double v) {
  const Vec3d d = c.a + (c.b - c.a) * v - c.x;
  const auto at = [&](double w) {
    const Vec3d p0(c.p[0].x, c.p[0].y, c.p[0].z), p1(c.p[1].x, c.p[1].y, c.p[1].z);
    const Vec3d centre = p0 + (p1 - p0) * w - c.x;
    const double s = std::clamp(centre.dot(d) / d.length2(), 0., 1.);
    return (centre - d * s).length() - (c.p[0].w + (double{c.p[1].w} - c.p[0].w) * w);
  };
  double lo = 0, hi = 1;
  for (int i = 0; i < 100; ++i) {
    const double third = (hi - lo) / 3;
    (at(lo + third) < at(hi - third) ? hi : lo) += (at(lo + third) < at(hi - third) ? -third : third);
  }
  return std::min({at(0.5 * (lo + hi)), at(0), at(1)});
}

TEST(Tube, HidesWhatASearchFindsHidden) {
  Random random(5);
  int hidden_points = 0, partly = 0;
  for (int i = 0; i < 20000; ++i) {
    const Case c = random_case(random);
    const Interval hidden = hidden_by_tube(TubeFan(c.x, c.a - c.x, c.b - c.x), TubeSegment(c.p));
    const bool any = hidden.lo < hidden.hi;
    partly += any && hidden.length() < 1;
    const double size = 2 + (c.a - c.x).length() + (c.b - c.x).length();
    for (int k = 0; k <= 20; ++k) {
      // Where the ends are, just beside them, and between.
      const double v = k < 8 && any ? (k < 4 ? hidden.lo : hidden.hi) + (k % 4 - 1.5) * 1e-4 : k / 20.;
      if (v <= 0 || v >= 1) continue;
      const double gap = clearance(c, v);
      if (std::abs(gap) < 1e-7 * size) continue;  // ends are single precision
      const bool inside = any && v > hidden.lo && v < hidden.hi;
      hidden_points += inside;
      ASSERT_EQ(inside, gap < 0) << "case " << i << " v " << v << " gap " << gap << " [" << hidden.lo << ","
                                 << hidden.hi << "] r " << c.p[0].w << " " << c.p[1].w;
    }
  }
  EXPECT_GT(hidden_points, 20000);
  EXPECT_GT(partly, 5000);
}

/// Chains of random walks.
Tubes fur(int strands, int steps, float length, float radius, uint32_t seed) {
  Random random(seed);
  Tubes tubes;
  for (int i = 0; i < strands; ++i) {
    Vec3f p = random.in_cube(), d = random.direction();
    for (int k = 0; k <= steps; ++k) {
      if (k > 0) tubes.segments.push_back(static_cast<uint32_t>(tubes.points.size() - 1));
      const float u = static_cast<float>(k) / static_cast<float>(steps);
      tubes.points.emplace_back(p.x, p.y, p.z, radius * (1 - 0.8f * u));
      tubes.us.push_back(u);
      d = (d + random.in_cube() * 0.3f).normalized();
      p += d * (length / static_cast<float>(steps));
    }
  }
  return tubes;
}

const TriangleMesh kNothing;

struct Furry {
  Furry(Tubes t, const TriangleMesh& m) : tubes(std::move(t)), mesh(m) {
    inputs = {{&kNothing, {}, true, &tubes}, {&mesh, {}, true}};
  }
  Tubes tubes;
  TriangleMesh mesh;
  std::vector<MeshInput> inputs;
};

TEST(Tube, EveryPathGivesTheSameBitsAsEverySegment) {
  const Furry scene(fur(300, 6, 0.8f, 0.01f, 3), soup(60, 0.2f, 4));
  const auto bvh = build_line_bvh(scene.inputs, {}, {}, 1);
  ASSERT_TRUE(bvh.ok());
  const Furry alone(Tubes(), scene.mesh);
  const auto without = build_line_bvh(alone.inputs, {}, {}, 1);
  ASSERT_TRUE(without.ok());
  std::vector<LinePath> paths{LinePath::kScalar, LinePath::kAvx2};
  if (widest_line_path() == LinePath::kAvx512) paths.push_back(LinePath::kAvx512);
  Random random(9);
  QueryCounters counters;
  std::vector<IntervalSet> expected, out;
  size_t intervals = 0;
  for (int i = 0; i < 2000; ++i) {
    const LineQuery query = random_query(random);
    visible_lines(*without, LinePath::kScalar, {&query, 1}, expected, counters);
    const Vec3d x(query.x);
    const TubeFan fan(x, Vec3d(query.a) - x, Vec3d(query.b) - x);
    for (const uint32_t first : scene.tubes.segments) {
      const Interval hidden = hidden_by_tube(fan, TubeSegment(&scene.tubes.points[first]));
      expected[0].subtract(hidden.lo, hidden.hi);
    }
    intervals += expected[0].size();
    for (const LinePath path : paths) {
      visible_lines(*bvh, path, {&query, 1}, out, counters);
      ASSERT_EQ(out[0], expected[0]) << name_of(path) << " query " << i;
    }
  }
  EXPECT_GT(intervals, 4000u);
}

// Embree works in single precision: only within its roundings of a silhouette may it disagree.
TEST(Tube, RaysAndLinesSeeTheSameSurface) {
  for (const float radius : {0.1f, 0.01f, 0.0003f}) {
    const Furry scene(fur(200, 6, 1, radius, 3), soup(1, 1e-4f, 4));
    const auto geometry = Geometry::build(scene.inputs, {}, {}, 1);
    ASSERT_TRUE(geometry.ok());
    Random random(11);
    QueryCounters counters;
    std::vector<IntervalSet> out;
    int hidden = 0, differ = 0, asked = 0;
    for (int i = 0; i < 4000; ++i) {
      const LineQuery query = random_query(random);
      geometry->visible({&query, 1}, out, counters);
      for (int k = 0; k < 10; ++k, ++asked) {
        const float v = random.uniform();
        const Vec3f p = query.a + (query.b - query.a) * v;
        const bool occluded = geometry->occluded(query.x, p, counters);
        hidden += occluded;
        differ += occluded == out[0].contains(v);
      }
    }
    EXPECT_GT(hidden, radius < 0.001f ? 20 : 500);
    // About 1e-6 of a length in each silhouette, two of them, 1,200 segments with a few in each query's way.
    EXPECT_LE(differ, asked / 4000 + (radius > 0.05f ? asked / 1000 : 0))
        << radius << ": " << hidden << " hidden";
  }
}

TEST(Tube, AHitIsOnTheRayAndOnTheSurface) {
  const Furry scene(fur(200, 6, 1, 0.05f, 7), soup(1, 1e-4f, 4));
  const auto geometry = Geometry::build(scene.inputs, {}, {}, 1);
  ASSERT_TRUE(geometry.ok());
  Random random(13);
  QueryCounters counters;
  int hits = 0, caps = 0;
  for (int i = 0; i < 20000; ++i) {
    const Ray ray{random.in_cube() * 3, random.direction(), 0, 100};
    const auto hit = geometry->intersect(ray, counters);
    if (!hit || hit->id.mesh != 0) continue;
    ++hits;
    const TubeSegment s(&scene.tubes.points[scene.tubes.segments[hit->id.primitive]]);
    const TubePoint at = tube_point(s, hit->u, hit->v);
    caps += at.w == 0 || at.w == 1;
    EXPECT_NEAR(at.normal.length(), 1, 1e-6);
    const Vec3d p = s.centre(at.w) + at.normal * s.radius(at.w);
    EXPECT_LT((p - Vec3d(ray.origin) - Vec3d(ray.direction) * double{hit->distance}).length(), 3e-6) << i;
    const bool outside = at.normal.dot(Vec3d(ray.direction)) < 1e-3;
    hits -= !outside;  // a ray that starts within a tube
  }
  EXPECT_GT(hits, 1000);
  EXPECT_GT(caps, 100);
}

TEST(Tube, StandsInAShaftsWay) {
  Tubes one;
  one.points = {V4f(-1, 0, 1, 0.01f), V4f(1, 0, 1, 0.01f)};
  one.us = {0, 1};
  one.segments = {0};
  const Furry scene(std::move(one), soup(1, 1e-4f, 4));
  const auto geometry = Geometry::build(scene.inputs, {}, {}, 1);
  ASSERT_TRUE(geometry.ok());
  Shaft shaft;
  QueryCounters counters;
  const auto content = [&](float y) {
    const LightPolygon light = LightPolygon::quad({-1, y + 0.5f, 2}, {2, 0, 0}, {0, -1, 0}, {}, 0);
    geometry->enter({Vec3f(0.1f, 0, -1), &light, Vec3f(0, 0, 1)}, shaft, counters);
    return shaft.content();
  };
  EXPECT_EQ(content(0), ShaftContent::kMany);
  EXPECT_EQ(content(3), ShaftContent::kClear);
}

}  // namespace
}  // namespace penumbra::testing
