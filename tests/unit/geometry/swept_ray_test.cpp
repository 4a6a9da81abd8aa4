#include "worker/geometry/swept_ray.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace penumbra {
namespace {

/// Does the ray at s meet the triangle? Möller & Trumbore's test, which shares nothing with the intervals.
bool meets(const SweptRay& ray, double s, const Vec3f p[3]) {
  const Vec3d o = ray.origin_at(s), d = ray.direction_at(s), p0(p[0]);
  const Vec3d e1 = Vec3d(p[1]) - p0, e2 = Vec3d(p[2]) - p0, h = d.cross(e2), t = o - p0, q = t.cross(e1);
  const double det = e1.dot(h), u = t.dot(h) / det, v = d.dot(q) / det;
  return u > 0 && v > 0 && u + v < 1 && e2.dot(q) / det > 0;
}

/// Where origin and direction change alike much, the square in s counts: edges are crossed there and back.
TEST(SweptRay, CoversAreThoseOfTheRayAtEachTime) {
  constexpr int kTimes = 1000;
  std::mt19937 numbers(5);
  std::uniform_real_distribution<double> any(-1, 1);
  const auto vector = [&](double size) { return Vec3d(any(numbers), any(numbers), any(numbers)) * size; };
  int apart = 0, met = 0, twice = 0;
  for (int i = 0; i < 2000; ++i) {
    Vec3f p[3];
    for (Vec3f& corner : p) corner = Vec3f(vector(1));
    const SweptRay ray{{Vec3d(0, 0, 3) + vector(1.5), Vec3d(0, 0, 3) + vector(1.5)},
                       {Vec3d(0, 0, -3) + vector(2), Vec3d(0, 0, -3) + vector(2)}};
    TimeCover covers[kMostCovers];
    const int n = covers_of_triangle(ray, p, covers);
    twice += n > 1;
    for (int k = 0; k < kTimes; ++k) {
      const double s = (k + 0.5) / kTimes;
      const bool covered =
          std::any_of(covers, covers + n, [s](const TimeCover& c) { return c.lo < s && s < c.hi; });
      met += covered;
      apart += covered != meets(ray, s, p);
    }
  }
  EXPECT_GT(met, 50'000);
  EXPECT_GT(twice, 2) << "some leave a triangle and come back";
  EXPECT_LE(apart, 2);
}

}  // namespace
}  // namespace penumbra
