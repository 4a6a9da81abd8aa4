// Rays and the whole of Geometry: identities, instances, alpha, bounds.
#include "worker/geometry/geometry.h"

#include <gtest/gtest.h>

#include <limits>
#include <thread>

#include "tests/unit/geometry/random_scenes.h"

namespace penumbra::testing {
namespace {

/// A point on a light that is not there itself, facing down.
LightEnd alone(const Vec3d& p) {
  return {p, {{0, 0, -1}}, {}};
}

constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// Unit square at height z, facing up.
TriangleMesh square(float z, float half = 1) {
  TriangleMesh mesh;
  mesh.positions = {{-half, -half, z}, {half, -half, z}, {half, half, z}, {-half, half, z}};
  mesh.indices = {0, 1, 2, 0, 2, 3};
  return mesh;
}

Geometry build(const std::vector<MeshInput>& meshes, const std::vector<ObjectInput>& objects = {},
               const std::vector<InstanceInput>& instances = {}) {
  auto geometry = Geometry::build(meshes, objects, instances, 2);
  EXPECT_TRUE(geometry.ok());
  return *std::move(geometry);
}

TEST(Geometry, NearestHitHasIdDistanceAndBarycentrics) {
  const TriangleMesh low = square(0), high = square(1);
  const Geometry geometry = build({{&low}, {&high}});
  QueryCounters counters;
  const auto hit = geometry.intersect({{0.5f, 0.25f, 3}, {0, 0, -2}, 0, kInfinity}, counters);
  ASSERT_TRUE(hit);
  EXPECT_EQ(hit->id, (PrimitiveId{kNone, 1, 0}));
  EXPECT_FLOAT_EQ(hit->distance, 1);
  const Vec3f p =
      high.positions[0] * (1 - hit->u - hit->v) + high.positions[1] * hit->u + high.positions[2] * hit->v;
  EXPECT_NEAR(p.x, 0.5f, 1e-6f);
  EXPECT_NEAR(p.y, 0.25f, 1e-6f);
  EXPECT_FALSE(geometry.intersect({{0, 0, 3}, {0, 0, 1}, 0, kInfinity}, counters));
  EXPECT_EQ(counters.rays, 2u);
}

TEST(Geometry, OccludedIsStrictlyBetween) {
  const TriangleMesh mesh = square(1);
  const Geometry geometry = build({{&mesh}});
  QueryCounters counters;
  EXPECT_TRUE(geometry.occluded({0.1f, 0, 0}, {0.1f, 0, 2}, counters));
  EXPECT_FALSE(geometry.occluded({0.1f, 0, 0}, {0.1f, 0, 0.999f}, counters));
  EXPECT_FALSE(geometry.occluded({0.1f, 0, 0}, {3, 0, 2}, counters));
}

TEST(Geometry, InvisibleMeshesAreMetByNothing) {
  const TriangleMesh mesh = square(1);
  const Geometry geometry = build({{&mesh, {}, false}});
  QueryCounters counters;
  EXPECT_FALSE(geometry.occluded({0, 0, 0}, {0, 0, 2}, counters));
  std::vector<IntervalSet> visible;
  const LineQuery query{{0, 0, 0}, {-1, 0.1f, 2}, {1, 0.1f, 2}};
  geometry.visible({&query, 1}, visible, counters);
  EXPECT_EQ(visible[0].length(), 1);
}

TEST(Geometry, AlphaIsForRaysOnly) {
  const TriangleMesh opaque = square(1, 0.5f), leaf = square(2, 10);
  // Only the first triangle counts: below the diagonal, x > y.
  const AlphaTest alpha = [](uint32_t primitive, float, float) { return primitive == 0; };
  const Geometry geometry = build({{&opaque}, {&leaf, alpha}});
  QueryCounters counters;
  EXPECT_TRUE(geometry.has_alpha());
  const Vec3f x(0, 0, 0);
  EXPECT_TRUE(geometry.occluded(x, {6, 0, 3}, counters));
  EXPECT_FALSE(geometry.occluded(x, {0, 6, 3}, counters));
  EXPECT_TRUE(geometry.occluded_by_alpha(x, alone({6, 0, 3}), counters));
  EXPECT_FALSE(geometry.occluded_by_alpha(x, alone({0, 6, 3}), counters));
  EXPECT_TRUE(geometry.occluded(x, {0.1f, 0.3f, 3}, counters));
  EXPECT_FALSE(geometry.occluded_by_alpha(x, alone({0.1f, 0.3f, 3}), counters));
  const LineQuery query{x, {6, 1, 3}, {9, 1, 3}};
  std::vector<IntervalSet> visible;
  geometry.visible({&query, 1}, visible, counters);
  EXPECT_EQ(visible[0].length(), 1) << "lines do not see alpha-tested meshes";
}

TEST(Geometry, NothingAtAll) {
  const Geometry geometry = build({});
  QueryCounters counters;
  EXPECT_FALSE(geometry.has_alpha());
  EXPECT_FALSE(geometry.occluded({0, 0, 0}, {0, 0, 1}, counters));
  EXPECT_FALSE(geometry.occluded_by_alpha({0, 0, 0}, alone({0, 0, 1}), counters));
  const LineQuery query{{0, 0, 0}, {-1, 0, 2}, {1, 0, 2}};
  std::vector<IntervalSet> visible;
  geometry.visible({&query, 1}, visible, counters);
  EXPECT_EQ(visible[0].length(), 1);
  Vec3f lo, hi;
  geometry.bounds(lo, hi);
  EXPECT_GT(lo.x, hi.x);
  EXPECT_EQ(geometry.line_bytes_per_triangle(), 0);
}

TEST(Geometry, TheLightsOwnTrianglesNeverHide) {
  const TriangleMesh light = square(2), before = square(1, 0.25f);
  const Geometry geometry = build({{&before}, {&light}});
  QueryCounters counters;
  std::vector<IntervalSet> visible;
  const LineQuery without{{0, 0, 0}, {-1, 0.3f, 2}, {1, 0.3f, 2}, {kNone, 1, 0}, 2};
  geometry.visible({&without, 1}, visible, counters);
  ASSERT_EQ(visible[0].size(), 2u);
  EXPECT_FLOAT_EQ(visible[0][0].hi, 0.25f);
  EXPECT_FLOAT_EQ(visible[0][1].lo, 0.75f);
  // A chord behind the light, were it not its own: the square hides it all.
  LineQuery beyond{{0, 0, 0}, {-1, 0.3f, 2.5f}, {1, 0.3f, 2.5f}};
  geometry.visible({&beyond, 1}, visible, counters);
  EXPECT_TRUE(visible[0].empty());
  beyond.light = {kNone, 1, 0};
  beyond.light_primitives = 2;
  geometry.visible({&beyond, 1}, visible, counters);
  EXPECT_EQ(visible[0].size(), 2u);
}

TEST(Geometry, SingularInstanceIsTheUsersFault) {
  const TriangleMesh mesh = square(0);
  Matrix flat;
  flat[2][2] = 0;
  const MeshInput input{&mesh};
  const ObjectInput object{0, 1};
  const InstanceInput instance{0, flat};
  const auto geometry = Geometry::build({&input, 1}, {&object, 1}, {&instance, 1}, 1);
  ASSERT_FALSE(geometry.ok());
  EXPECT_EQ(geometry.status().code(), absl::StatusCode::kInvalidArgument);
}

/// Instances answer as the same meshes placed by hand.
TEST(Geometry, InstancesEqualFlattened) {
  const TriangleMesh part = ball({0, 0, 0}, 0.4f, 10, 0.2f), world = soup(50, 0.3f, 4);
  std::vector<InstanceInput> instances;
  Random random(8);
  TriangleMesh flat = world;
  for (int i = 0; i < 40; ++i) {
    Matrix m;
    m.setScale(Vec3d(random.uniform(0.2f, 0.5f), random.uniform(0.2f, 0.5f), random.uniform(-0.5f, 0.5f)));
    m.rotate(Vec3d(random.direction()));
    m[3][0] = random.uniform(-1, 1), m[3][1] = random.uniform(-1, 1), m[3][2] = random.uniform(-1, 1);
    instances.push_back({0, m});
    const auto first = static_cast<uint32_t>(flat.positions.size());
    for (const Vec3f& p : part.positions) {
      Vec3d q;
      m.multVecMatrix(Vec3d(p), q);
      flat.positions.push_back(Vec3f(q));
    }
    for (const uint32_t index : part.indices) flat.indices.push_back(first + index);
  }
  const Geometry placed = build({{&world}, {&part}}, {{1, 2}}, instances), flattened = build({{&flat}});
  QueryCounters counters;
  int hits = 0;
  double sum = 0;
  for (int i = 0; i < 4000; ++i) {
    const LineQuery query = random_query(random);
    std::vector<IntervalSet> a, b;
    placed.visible({&query, 1}, a, counters);
    flattened.visible({&query, 1}, b, counters);
    // Flattened vertices are rounded: nearly end-on chords and grazing edges magnify that.
    const double difference = std::abs(a[0].length() - b[0].length());
    ASSERT_LT(difference, 0.02) << i;
    sum += difference;
    const Ray ray{query.x, query.a - query.x, 0, kInfinity};
    const auto ha = placed.intersect(ray, counters), hb = flattened.intersect(ray, counters);
    ASSERT_EQ(ha.has_value(), hb.has_value());
    if (!ha) continue;
    ++hits;
    EXPECT_NEAR(ha->distance, hb->distance, 1e-4f * hb->distance + 1e-5f);
    EXPECT_EQ(ha->id.instance == kNone, hb->id.primitive < world.triangles());
    if (ha->id.instance != kNone) {
      EXPECT_EQ(ha->id.mesh, 1u);
      EXPECT_EQ(world.triangles() + ha->id.instance * part.triangles() + ha->id.primitive, hb->id.primitive);
    }
  }
  EXPECT_LT(sum / 4000, 2e-6);
  EXPECT_GT(hits, 1000);
}

/// A job without lines does not pay for their hierarchy; those that have some may begin at the same time.
TEST(Geometry, LinesAreBuiltWhenOneIsAskedFor) {
  const TriangleMesh mesh = soup(3000, 0.2f, 31);
  const Geometry geometry = build({{&mesh}});
  QueryCounters counters;
  geometry.occluded({0, 0, -3}, {0, 0, 3}, counters);
  EXPECT_EQ(geometry.build_times().line_bvh_seconds, 0);
  const LineQuery query{{0.1f, 0, -3}, {-1, -1, 3}, {1, 1, 3}};
  std::vector<IntervalSet> found[4];
  std::vector<std::thread> threads;
  for (std::vector<IntervalSet>& visible : found) {
    threads.emplace_back([&] {
      QueryCounters own;
      geometry.visible({&query, 1}, visible, own);
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_GT(geometry.build_times().line_bvh_seconds, 0);
  const IntervalSet expected = visible_by(bvh_of({&mesh}), LinePath::kScalar, query);
  for (const std::vector<IntervalSet>& visible : found) EXPECT_EQ(visible.at(0), expected);
}

}  // namespace
}  // namespace penumbra::testing
