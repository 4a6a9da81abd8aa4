// Does the 95 % interval of relMSE hold the relMSE that an estimator shows on average over its seeds? A
// thousand noisy images of known variance, with difficulty that varies smoothly, with hard edges, and with
// the noise of few rare hits.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "film/metrics.h"

namespace penumbra {
namespace {

constexpr int kEdge = 64;
constexpr int kTrials = 1000;

FilmImage grey() {
  FilmImage image;
  image.width = image.height = kEdge;
  image.window = {0, 0, kEdge, kEdge};
  image.rgb.assign(3 * image.pixels(), 1);
  return image;
}

/// Standard deviation of a pixel: waves, and a disk (a shadow's edge) where it is three times as large.
double difficulty(int x, int y) {
  const double waves = std::exp(0.75 * std::sin(x / 7.0) + 0.6 * std::cos(y / 5.0));
  return 0.05 * waves * ((x - 30) * (x - 30) + (y - 30) * (y - 30) < 200 ? 3 : 1);
}

using Noise = std::function<void(std::mt19937&, double (&)[3])>;  ///< three channels, variance 1

/// How many of the intervals hold the truth.
int covered(const Noise& noise) {
  const FilmImage reference = grey();
  double truth = 0;
  for (int y = 0; y < kEdge; ++y)
    for (int x = 0; x < kEdge; ++x) truth += difficulty(x, y) * difficulty(x, y) / (1 + kRelMseEpsilon);
  truth /= kEdge * kEdge;
  int count = 0;
  for (unsigned t = 0; t < kTrials; ++t) {
    std::mt19937 random(t);
    FilmImage image = reference;
    for (int y = 0; y < kEdge; ++y)
      for (int x = 0; x < kEdge; ++x) {
        double channels[3];
        noise(random, channels);
        for (size_t c = 0; c < 3; ++c)
          image.rgb[3 * image.index(x, y) + c] += static_cast<float>(difficulty(x, y) * channels[c]);
      }
    const auto e = compare(image, reference);
    if (!e.ok() || !e->relmse_ci) return -1;
    count += e->relmse_ci->low <= truth && truth <= e->relmse_ci->high;
  }
  return count;
}

/// 93 to 97 % of the trials: 2.9 standard deviations of a true 95 %.
void expect_covered(int count) {
  EXPECT_GE(count, 930);
  EXPECT_LE(count, 970);
}

TEST(Coverage, NoiseOfEachChannelAlone) {
  expect_covered(covered([](std::mt19937& random, double(&c)[3]) {
    std::normal_distribution<double> normal;
    for (double& v : c) v = normal(random);
  }));
}

TEST(Coverage, GreyNoise) {
  expect_covered(covered([](std::mt19937& random, double(&c)[3]) {
    c[0] = c[1] = c[2] = std::normal_distribution<double>()(random);
  }));
}

TEST(Coverage, RareHits) {
  // A mean of 16 samples, each a hit with probability 1/8: E = 1/8, variance p(1 - p)/16.
  expect_covered(covered([](std::mt19937& random, double(&c)[3]) {
    const double hits = std::binomial_distribution<int>(16, 0.125)(random) / 16.0;
    c[0] = c[1] = c[2] = (hits - 0.125) / std::sqrt(0.125 * 0.875 / 16);
  }));
}

}  // namespace
}  // namespace penumbra
