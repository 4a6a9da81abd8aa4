#include "worker/sampling/warp.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "worker/sampling/hash.h"
#include "worker/sampling/sampler.h"

namespace penumbra {
namespace {

using std::numbers::pi;

Vec2d random_square(uint64_t i) {
  return {uniform(mix64(2 * i + 1)), uniform(mix64(2 * i + 2))};
}

/// |∂w/∂u × ∂w/∂v| of a warp to the unit sphere by central differences: the inverse of its density.
template <class Warp>
double jacobian(const Warp& warp, const Vec2d& u) {
  const double h = 1e-5;
  const Vec3d du = (warp({u.x + h, u.y}) - warp({u.x - h, u.y})) / (2 * h);
  const Vec3d dv = (warp({u.x, u.y + h}) - warp({u.x, u.y - h})) / (2 * h);
  return du.cross(dv).length();
}

TEST(Warp, DensityTimesJacobianIsOne) {
  for (uint64_t i = 0; i < 500; ++i) {
    const Vec2d u = random_square(i) * 0.98 + Vec2d(0.01);
    if (std::min(std::abs(u.x - u.y), std::abs(u.x + u.y - 1)) < 1e-3) continue;  // creases of the disk map
    EXPECT_NEAR(jacobian(square_to_sphere, u) / (4 * pi), 1, 1e-5);
    const auto cosine = [](const Vec2d& p) { return square_to_cosine_hemisphere(p); };
    EXPECT_NEAR(jacobian(cosine, u) * cosine_hemisphere_pdf(cosine(u).z), 1, 1e-4);
    for (const double q : {1.5, 0.1, 1e-6}) {
      const auto cone = [&](const Vec2d& p) { return square_to_cone(p, q); };
      EXPECT_NEAR(jacobian(cone, u) * cone_pdf(q), 1, 1e-5);
    }
  }
}

TEST(Warp, DirectionsAreUnitAndInRange) {
  for (uint64_t i = 0; i < 1000; ++i) {
    const Vec2d u = random_square(i);
    EXPECT_LE(square_to_disk_concentric(u).length(), 1 + 1e-15);
    EXPECT_NEAR(square_to_cosine_hemisphere(u).length(), 1, 1e-14);
    EXPECT_GE(square_to_cosine_hemisphere(u).z, 0);
    EXPECT_NEAR(square_to_sphere(u).length(), 1, 1e-14);
    const Vec3d d = square_to_cone(u, 1e-12);
    EXPECT_NEAR(d.length(), 1, 1e-14);
    EXPECT_LE(1 - d.z, 1.01e-12);
    const Vec2d b = square_to_triangle(u);
    EXPECT_TRUE(b.x >= 0 && b.y >= 0 && b.x + b.y <= 1) << b.x << " " << b.y;
  }
}

TEST(Warp, NarrowConesKeepTheirDigits) {
  // 1 − cosθ = 1e-20 is beyond 1 − z of a double; sinθ is not.
  const Vec3d d = square_to_cone({0.25, 0}, 1e-20);
  EXPECT_NEAR(d.x / std::sqrt(2 * 0.25e-20), 1, 1e-14);
}

TEST(Warp, FramesAreOrthonormalAndRightHanded) {
  for (uint64_t i = 0; i < 1000; ++i) {
    Vec3d n = square_to_sphere(random_square(i)), s, t;
    if (i == 0) n = {0, 0, -1};
    if (i == 1) n = {1e-9, 0, -1};
    frame(n, s, t);
    EXPECT_NEAR(s.length(), 1, 1e-14);
    EXPECT_NEAR(t.length(), 1, 1e-14);
    EXPECT_NEAR((s.cross(t) - n).length(), 0, 1e-14);
  }
}

TEST(Warp, CosineDensityIsZeroBelow) {
  EXPECT_EQ(cosine_hemisphere_pdf(-0.1), 0);
}

}  // namespace
}  // namespace penumbra
