#include "worker/lights/spot_cone.h"

#include <gtest/gtest.h>

#include <cmath>

#include "worker/sampling/hash.h"
#include "worker/sampling/sampler.h"

namespace penumbra {
namespace {

// Wherever the spot shines on the ray the cut keeps it, and what it keeps ends where the cone does.
TEST(SpotCone, KeepsWhatIsLitAndNoMore) {
  uint64_t key = 1;
  const auto random = [&] { return 2 * uniform(mix64(++key)) - 1; };
  int cut = 0, dark = 0;
  for (int k = 0; k < 4000; ++k) {
    SpotEmitter spot;
    spot.position = Vec3f(float(random()), float(random()), float(random()));
    spot.axis = Vec3f(Vec3d(random(), random(), random()).normalized());
    spot.intensity = Rgb(1);
    spot.cos_outer = float(0.5 + 0.4999 * random());
    spot.cos_inner = 1;
    const Vec3d o(3 * random(), 3 * random(), 3 * random()),
        d = Vec3d(random(), random(), random()).normalized();
    double t0 = 0, t1 = 8;
    const bool some = clip_to_cone(spot, o, d, t0, t1);
    cut += some && (t0 > 0 || t1 < 8) ? 1 : 0;
    dark += some ? 0 : 1;
    const auto cosine = [&](double t) {
      const Vec3d w = o + d * t - Vec3d(spot.position);
      return w.dot(Vec3d(spot.axis)) / w.length();
    };
    for (int i = 0; i <= 200; ++i) {
      const double t = i * 0.04;
      if (cosine(t) < double{spot.cos_outer}) continue;
      EXPECT_TRUE(some && t >= t0 && t <= t1)
          << k << ": lit at " << t << ", kept [" << t0 << "," << t1 << "]";
    }
    if (some && t0 > 0) {
      EXPECT_NEAR(cosine(t0), spot.cos_outer, 1e-5) << k;
    }
    if (some && t1 < 8) {
      EXPECT_NEAR(cosine(t1), spot.cos_outer, 1e-5) << k;
    }
  }
  EXPECT_GT(cut, 400);
  EXPECT_GT(dark, 400);
}

TEST(SpotCone, MoreThanAHalfSpaceIsNotCut) {
  SpotEmitter spot;
  spot.axis = Vec3f(0, 0, 1);
  spot.cos_outer = -0.5f;
  double t0 = 1, t1 = 2;
  EXPECT_TRUE(clip_to_cone(spot, Vec3d(0, 0, -5), Vec3d(1, 0, 0), t0, t1));
  EXPECT_EQ(t0, 1);
  EXPECT_EQ(t1, 2);
}

}  // namespace
}  // namespace penumbra
