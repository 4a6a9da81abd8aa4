// A surface must not shadow itself: rays that leave a point of a large flat plate, at any angle, meet
// nothing, wherever the plate lies and however it is turned.
#include <gtest/gtest.h>

#include <random>

#include "tests/support/render.h"
#include "worker/render/surface.h"

namespace penumbra {
namespace {

struct Plate {
  double size, away;  ///< edge length, distance of its centre from the origin
};

/// Rays that wrongly meet the plate they leave, of `n`.
int self_hits(const Plate& plate, uint32_t seed, int n) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(0, 1);
  const auto direction = [&] { return Vec3d(normal(random), normal(random), normal(random)).normalized(); };
  const Vec3d u = direction() * plate.size, w = direction(), v = u.cross(w).normalized() * plate.size * 0.2;
  const Vec3d o = direction() * plate.away - (u + v) * 0.5;
  std::string points;
  for (const Vec3d& p : {o, o + u, o + u + v, o + v})
    for (int k = 0; k < 3; ++k) points += std::to_string(float(p[k])) + " ";
  const ScenePtr scene = test::load_text(
      "Camera \"perspective\"\nWorldBegin\nShape \"trianglemesh\" \"integer indices\" [ 0 1 2 0 2 3 ] \"point P\" [ " +
      points + "]\n");
  if (!scene) return n;
  int hits = 0;
  QueryCounters counters;
  for (int i = 0; i < n; ++i) {
    Hit hit;
    hit.id = {kNone, 0, uint32_t(i % 2)};
    const double a = std::sqrt(uniform(random)), b = uniform(random);
    hit.u = float(a * b);
    hit.v = float(a * (1 - b));
    const Vec3f out(direction());
    const SurfacePoint point = surface_at(*scene, hit, -out, nullptr);
    // Half of the rays graze.
    const Vec3d along = (Vec3d(out) - Vec3d(point.ng) * Vec3d(point.ng).dot(Vec3d(out))).normalized();
    const double rise = i % 4 < 2 ? 1e-3 * uniform(random) : uniform(random);
    const Vec3f towards(along + Vec3d(point.ng) * rise);
    const Vec3f x = point.offset(towards);
    hits += scene->geometry->occluded(x, x + towards * float(3 * plate.size), counters);
    hits += scene->geometry->intersect({x, towards, 0, 1e30f}, counters).has_value();
  }
  return hits;
}

TEST(SelfShadow, PlatesDoNotShadowThemselves) {
  for (const Plate& plate : {Plate{8, 4}, Plate{8, 0}, Plate{0.01, 5}, Plate{1000, 10}, Plate{1, 1e4}})
    for (uint32_t seed = 0; seed < 20; ++seed)
      EXPECT_EQ(self_hits(plate, seed, 5000), 0) << "size " << plate.size << " away " << plate.away << " seed " << seed;
}

}  // namespace
}  // namespace penumbra
