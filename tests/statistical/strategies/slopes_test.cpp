// How fast variance falls with stratified samples, at the two pixels of gallery/monolith.pbrt: Salesin &
// Jarosz 2019, Figure 6. A jump in what a strategy integrates shows as a slope near −1.5, a continuous
// integrand as one near −2.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>

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
  return {xy / xx, std::sqrt(2.0 / (repeats - 1) / xx)};
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
  for (const char* mix : {"bsdf", "line-sa@u", "line-sa@v", "bsdf+line-sa@u", "bsdf+line-sa@v"}) {
    const Slope a = at_a(mix), b = at_b(mix);
    std::printf("%-40s A %.2f ± %.2f  B %.2f ± %.2f\n", mix, a.value, a.error, b.value, b.error);
  }
  for (const char* lines : {"line-sa@u", "line-sa@v"})
    for (const char* smooth : {"smooth=0.5", "smooth=1", "smooth=auto", "smooth-ease=auto"}) {
      const std::string mix = std::string("bsdf+") + lines + "/" + smooth;
      const Slope a = at_a(mix), b = at_b(mix);
      std::printf("%-40s A %.2f ± %.2f  B %.2f ± %.2f\n", mix.c_str(), a.value, a.error, b.value, b.error);
    }
}

}  // namespace
}  // namespace penumbra
