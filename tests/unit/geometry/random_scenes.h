#pragma once
// Scenes and chords for the tests of line queries.
#include <cmath>
#include <random>
#include <vector>

#include "worker/geometry/geometry.h"
#include "worker/geometry/line_bvh.h"
#include "worker/geometry/line_query.h"

namespace penumbra::testing {

class Random {
 public:
  explicit Random(uint32_t seed) : engine_(seed) {}
  float uniform(float lo = 0, float hi = 1) { return std::uniform_real_distribution<float>(lo, hi)(engine_); }
  Vec3f in_cube() { return {uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)}; }
  Vec3f direction() {
    for (;;) {
      const Vec3f d = in_cube();
      if (d.length2() <= 1 && d.length2() > 0.01f) return d.normalized();
    }
  }

 private:
  std::mt19937 engine_;
};

/// Loose triangles of about the given size in [-1,1]³.
inline TriangleMesh soup(int triangles, float size, uint32_t seed) {
  Random random(seed);
  TriangleMesh mesh;
  for (int i = 0; i < triangles; ++i) {
    const Vec3f at = random.in_cube();
    for (int c = 0; c < 3; ++c) {
      mesh.indices.push_back(static_cast<uint32_t>(mesh.positions.size()));
      mesh.positions.push_back(at + random.in_cube() * size);
    }
  }
  return mesh;
}

/// Loose pairs of triangles with an edge in common, bent at any angle, each listed from any vertex on.
inline TriangleMesh loose_pairs(int pairs, float size, uint32_t seed) {
  Random random(seed);
  TriangleMesh mesh;
  for (int i = 0; i < pairs; ++i) {
    const Vec3f at = random.in_cube();
    const auto first = static_cast<uint32_t>(mesh.positions.size());
    for (int c = 0; c < 4; ++c) mesh.positions.push_back(at + random.in_cube() * size);
    for (uint32_t own = 2; own < 4; ++own) {
      const uint32_t corners[3] = {first, first + 1, first + own};
      const auto from = static_cast<size_t>(random.uniform(0, 2.999f));
      const size_t step = random.uniform() < 0.5f ? 1 : 2;
      for (size_t c = 0; c < 3; ++c) mesh.indices.push_back(corners[(from + step * c) % 3]);
    }
  }
  return mesh;
}

/// A closed, bumpy ball around `centre`: an octahedron split `levels` times.
inline TriangleMesh ball(const Vec3f& centre, float radius, int rings, float bumps = 0) {
  TriangleMesh mesh;
  const int around = 2 * rings;
  const float pi = 3.14159265f;
  const auto at = [&](int ring, int step) {
    const float theta = pi * static_cast<float>(ring) / static_cast<float>(rings);
    const float phi = 2 * pi * static_cast<float>(step) / static_cast<float>(around);
    const Vec3f d(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta));
    return centre + d * (radius * (1 + bumps * std::sin(5 * phi) * std::sin(4 * theta)));
  };
  mesh.positions.push_back(centre + Vec3f(0, 0, radius));
  for (int ring = 1; ring < rings; ++ring) {
    for (int step = 0; step < around; ++step) mesh.positions.push_back(at(ring, step));
  }
  mesh.positions.push_back(centre - Vec3f(0, 0, radius));
  const auto last = static_cast<uint32_t>(mesh.positions.size() - 1);
  const auto index = [&](int ring, int step) {
    return ring == 0       ? 0u
           : ring == rings ? last
                           : static_cast<uint32_t>(1 + (ring - 1) * around + step % around);
  };
  for (int ring = 0; ring < rings; ++ring) {
    for (int step = 0; step < around; ++step) {
      const uint32_t a = index(ring, step), b = index(ring + 1, step), c = index(ring + 1, step + 1),
                     d = index(ring, step + 1);
      if (ring + 1 < rings) mesh.indices.insert(mesh.indices.end(), {a, b, c});
      if (ring > 0) mesh.indices.insert(mesh.indices.end(), {a, c, d});
    }
  }
  return mesh;
}

inline LineQuery random_query(Random& random) {
  return {random.in_cube(), random.in_cube(), random.in_cube()};
}

inline LineBvh bvh_of(const std::vector<const TriangleMesh*>& meshes) {
  std::vector<MeshInput> inputs;
  for (const TriangleMesh* mesh : meshes) inputs.push_back({mesh});
  return *build_line_bvh(inputs, {}, {}, 1);
}

inline IntervalSet visible_by(const LineBvh& bvh, LinePath path, const LineQuery& query) {
  std::vector<IntervalSet> out;
  QueryCounters counters;
  visible_lines(bvh, path, {&query, 1}, out, counters);
  return out[0];
}

}  // namespace penumbra::testing
