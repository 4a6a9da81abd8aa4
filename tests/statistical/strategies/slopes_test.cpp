// How fast variance falls with stratified samples, at the two pixels of gallery/monolith.pbrt: Salesin &
// Jarosz 2019, Figure 6. A jump in what a strategy integrates shows as a slope near −1.5, a continuous
// integrand as one near −2.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "tests/support/render.h"
#include "tests/support/shading.h"
#include "worker/render/camera.h"

namespace penumbra {
namespace {

/// Luminance's variance over independently scrambled patterns.
double variance(const Scene& scene, const ShadingPoint& point, const Mix& mix, int repeats) {
  QueryCounters counters;
  const PreparedMix prepared(mix, scene.lights);
  DirectLight direct({*scene.geometry, scene.lights}, prepared, counters);
  double mean = 0, m2 = 0;
  for (int r = 0; r < repeats; ++r) {
    const PassSampler sampler(SamplerKind::kStratified, 5, 0, TaskKind::kRun, 0, r, 1);
    const double value = direct.estimate(point, sampler, 0).y, d = value - mean;
    mean += d / (r + 1);
    m2 += d * (value - mean);
  }
  return m2 / (repeats - 1);
}

struct Slope {
  double value, error;  ///< and its standard error
};

/// Least squares of log variance over log count, 16 to 4096 samples a strategy in squares.
Slope slope(const Scene& scene, const ShadingPoint& point, const std::string& text) {
  Mix mix = parse_mix(text).value();
  const int repeats = 200;
  std::vector<double> x, y;
  for (int side = 4; side <= 64; side *= 2) {
    for (StrategyCount& s : mix.strategies) s.count = side * side;
    x.push_back(2 * std::log(side));
    y.push_back(std::log(variance(scene, point, mix, repeats)));
  }
  double mx = 0, my = 0, xx = 0, xy = 0;
  for (size_t i = 0; i < x.size(); ++i) mx += x[i] / double(x.size()), my += y[i] / double(x.size());
  for (size_t i = 0; i < x.size(); ++i) xx += (x[i] - mx) * (x[i] - mx), xy += (x[i] - mx) * (y[i] - my);
  // log of a variance of n near normal numbers has the standard error √(2/(n − 1)).
  const Slope slope{xy / xx, std::sqrt(2.0 / (repeats - 1) / xx)};
  std::printf("%-40s %.2f ± %.2f\n", text.c_str(), slope.value, slope.error);
  return slope;
}

class Slopes : public ::testing::Test {
 protected:
  static constexpr int kSize = 256;
  const ScenePtr scene_ = test::load(PENUMBRA_SOURCE_DIR "/scenes/gallery/monolith.pbrt");

  test::Met at(int x, int y) const {
    const Camera camera = Camera::build(scene_->description, kSize, kSize).value();
    const CameraRay ray = camera.ray({x + 0.5, y + 0.5});
    return test::Met(*scene_, ray.origin, ray.direction);
  }
  Slope at_a(const std::string& mix) const { return slope(*scene_, at(128, 84).point(), mix); }
  Slope at_b(const std::string& mix) const { return slope(*scene_, at(85, 178).point(), mix); }
};

TEST_F(Slopes, LinesSeeWhatPointsTripOver) {
  ASSERT_TRUE(scene_);
  // Standard errors are 0.02. Where all of the light is in view there is nothing but points that miss it.
  EXPECT_NEAR(at_a("bsdf").value, -1.5, 0.1);
  EXPECT_LT(at_a("line-sa@u").value, -1.95);
  EXPECT_LT(at_a("line-sa@v").value, -1.95);
  EXPECT_NEAR(at_a("bsdf+line-sa@u").value, -1.5, 0.1);
  // The edge of B's penumbra is upright: lines across it see it, lines along it do not.
  EXPECT_LT(at_b("line-sa@u").value, -2.3);
  EXPECT_NEAR(at_b("line-sa@v").value, -1.5, 0.15);
}

TEST_F(Slopes, SmoothingIsFasterAndNeverSlower) {
  ASSERT_TRUE(scene_);
  EXPECT_LT(at_a("bsdf+line-sa@u/smooth=auto").value, -1.85);
  EXPECT_LT(at_b("bsdf+line-sa@u/smooth=auto").value, at_b("bsdf+line-sa@u").value);
  EXPECT_LT(at_b("bsdf+line-sa@v/smooth=auto").value, at_b("bsdf+line-sa@v").value + 0.06);
}

}  // namespace
}  // namespace penumbra
