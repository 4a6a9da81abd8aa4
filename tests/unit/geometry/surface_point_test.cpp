#include "worker/geometry/surface_point.h"

#include <gtest/gtest.h>

#include "tests/unit/geometry/random_scenes.h"

namespace penumbra::testing {
namespace {

/// A point by barycentrics with the renderer's error bound: gamma(7) Σ |b_i p_i|, pbrt-v3 §3.9.
SurfacePoint point_on(const Vec3f p[3], float u, float v) {
  const double roundoff = 0x1p-24, gamma = 7 * roundoff / (1 - 7 * roundoff);
  SurfacePoint s;
  s.p = p[0] * (1 - u - v) + p[1] * u + p[2] * v;
  for (int k = 0; k < 3; ++k) {
    s.p_error[k] = static_cast<float>(gamma) *
                   (std::abs((1 - u - v) * p[0][k]) + std::abs(u * p[1][k]) + std::abs(v * p[2][k]));
  }
  s.ng = (p[1] - p[0]).cross(p[2] - p[0]).normalized();
  return s;
}

/// Height over the triangle's plane, in units of nothing but sign.
double side(const Vec3f p[3], const Vec3f& x) {
  const Vec3d q = Vec3d(x) - Vec3d(p[0]);
  return (Vec3d(p[1]) - Vec3d(p[0])).cross(Vec3d(p[2]) - Vec3d(p[0])).dot(q);
}

TEST(SurfacePoint, OffsetLeavesThePlaneOnTheAskedSide) {
  Random random(1);
  for (const float at : {0.f, 1.f, 1e3f, 1e6f}) {
    for (const float size : {1e-3f, 1.f, 1e3f}) {
      for (int i = 0; i < 2000; ++i) {
        const Vec3f centre = random.in_cube() * at;
        const Vec3f p[3] = {centre + random.in_cube() * size, centre + random.in_cube() * size,
                            centre + random.in_cube() * size};
        const Vec3f n = (p[1] - p[0]).cross(p[2] - p[0]);
        if (!(n.length() > 1e-3f * size * size)) continue;  // slivers have no plane in single precision
        const float u = random.uniform(), v = random.uniform() * (1 - u);
        const SurfacePoint s = point_on(p, u, v);
        const Vec3f towards = random.direction();
        const double expected = s.ng.dot(towards) < 0 ? -1 : 1;
        // Far out, the normal from rounded corners tilts the plane more than the bound knows.
        if (at > 1e3f * size) continue;
        EXPECT_GT(expected * side(p, s.offset(towards)), 0) << at << " " << size << " " << i;
      }
    }
  }
}

TEST(SurfacePoint, OffsetStaysWithinAFewRoundings) {
  SurfacePoint s;
  s.p = {1, 2, 3};
  s.p_error = Vec3f(1e-6f);
  s.ng = {0, 0, 1};
  const Vec3f up = s.offset({0, 0, 1}), down = s.offset({1, 0, -1});
  EXPECT_GT(up.z, 3.000001f - 2e-7f);
  EXPECT_LT(up.z, 3.000002f);
  EXPECT_LT(down.z, 3 - 1e-6f + 2e-7f);
  EXPECT_EQ(up.x, 1);
  EXPECT_EQ(down.y, 2);
}

}  // namespace
}  // namespace penumbra::testing
