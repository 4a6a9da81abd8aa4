#pragma once
// Near-degenerate meshes in [-1,1]³ for the tests of line queries.
#include "tests/unit/geometry/random_scenes.h"

namespace penumbra::testing {

inline void add_triangle(TriangleMesh& mesh, const Vec3f& p0, const Vec3f& p1, const Vec3f& p2) {
  for (const Vec3f& p : {p0, p1, p2}) {
    mesh.indices.push_back(static_cast<uint32_t>(mesh.positions.size()));
    mesh.positions.push_back(p);
  }
}

/// Loose triangles of length about 1 whose width is a random power of ten between 1 and 1e-5.
inline TriangleMesh needles(int triangles, uint32_t seed) {
  Random random(seed);
  TriangleMesh mesh;
  for (int i = 0; i < triangles; ++i) {
    const Vec3f at = random.in_cube(), along = random.direction(), across = random.direction();
    add_triangle(mesh, at, at + along,
                 at + along * random.uniform() + across * std::pow(10.f, -random.uniform(0, 5)));
  }
  return mesh;
}

/// Parallel squares one above the other, `gap` apart, each a little aside of the last.
inline TriangleMesh plates(int count, float gap) {
  TriangleMesh mesh;
  for (int i = 0; i < count; ++i) {
    const float z = 0.25f + static_cast<float>(i) * gap, s = 0.01f * static_cast<float>(i);
    const Vec3f p00(-0.7f + s, -0.6f, z), p10(0.5f + s, -0.6f, z), p11(0.5f + s, 0.6f - s, z),
        p01(-0.7f + s, 0.6f - s, z);
    add_triangle(mesh, p00, p10, p11);
    add_triangle(mesh, p00, p11, p01);
  }
  return mesh;
}

/// Slats across x, tilted by turns, as wide as the gaps between them.
inline TriangleMesh slats(int count) {
  TriangleMesh mesh;
  const float pitch = 1.8f / static_cast<float>(count), lift = 0.4f * pitch;
  for (int i = 0; i < count; ++i) {
    const float x0 = -0.9f + static_cast<float>(i) * pitch, x1 = x0 + 0.5f * pitch;
    const float z0 = i % 2 == 0 ? 0 : lift, z1 = lift - z0;
    const Vec3f p00(x0, -0.8f, z0), p10(x1, -0.8f, z1), p11(x1, 0.8f, z1), p01(x0, 0.8f, z0);
    add_triangle(mesh, p00, p10, p11);
    add_triangle(mesh, p00, p11, p01);
  }
  return mesh;
}

}  // namespace penumbra::testing
