#include "tests/bench/geometry/exact_scene.h"

#include <Imath/ImathBox.h>

#include <array>

#include "proto/status.h"
#include "tests/unit/geometry/exact_lines.h"

namespace penumbra::bench {
namespace {

struct Triangle {
  std::array<Vec3f, 3> p;
  PrimitiveId id;
};

/// Of all triangles, those that can hide anything of a cluster.
std::vector<Triangle> candidates(const BenchScene& scene, const Imath::Box3f& cluster) {
  std::vector<Triangle> found;
  for (uint32_t m = 0; m < scene.meshes.size(); ++m) {
    const TriangleMesh& mesh = scene.meshes[m];
    for (uint32_t i = 0; i < mesh.triangles(); ++i) {
      Triangle t{{}, {kNone, m, i}};
      Imath::Box3f box;
      for (size_t c = 0; c < 3; ++c) box.extendBy(t.p[c] = mesh.positions[mesh.indices[3 * size_t{i} + c]]);
      if (box.intersects(cluster)) found.push_back(t);
    }
  }
  return found;
}

bool of_light(const PrimitiveId& id, const LineQuery& query) {
  return id.mesh == query.light.mesh && id.primitive - query.light.primitive < query.light_primitives;
}

void compare(const Geometry& geometry, const std::vector<Triangle>& triangles, const LineQuery& query,
             Exactness& sum) {
  testing::HiddenBounds bounds;
  const testing::ExactChord chord(query);
  for (const Triangle& t : triangles)
    if (!chord.misses(t.p.data()) && !of_light(t.id, query)) chord.add(t.p.data(), bounds);
  QueryCounters counters;
  std::vector<IntervalSet> visible;
  geometry.visible({&query, 1}, visible, counters);
  ++sum.chords;
  sum.partly += visible[0].size() > 1 || (visible[0].size() == 1 && visible[0].length() < 1);
  sum.doubtful += bounds.doubtful > 0;
  sum.wrong += testing::contradiction(visible[0], bounds) >= 0;
  sum.triangles += static_cast<double>(triangles.size());
}

}  // namespace

Exactness compare_with_all(const Geometry& geometry, const BenchScene& scene, size_t chords, uint32_t seed) {
  PENUMBRA_CHECK(scene.instances.empty());
  constexpr size_t kCluster = 256;
  Exactness sum;
  const auto points = tile_coherent_points(geometry, scene, chords, 1, seed);
  for (size_t first = 0; first < points.size(); first += kCluster) {
    const size_t last = std::min(points.size(), first + kCluster);
    Imath::Box3f box;
    for (size_t i = first; i < last; ++i) {
      const LineQuery& query = points[i].lines[0];
      for (const Vec3f* p : {&query.x, &query.a, &query.b}) box.extendBy(*p);
    }
    const std::vector<Triangle> triangles = candidates(scene, box);
    for (size_t i = first; i < last; ++i) compare(geometry, triangles, points[i].lines[0], sum);
  }
  if (sum.chords > 0) sum.triangles /= static_cast<double>(sum.chords);
  return sum;
}

}  // namespace penumbra::bench
