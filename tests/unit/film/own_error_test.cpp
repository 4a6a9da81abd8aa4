#include "film/own_error.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "film/metrics.h"
#include "film/own_error_pixels.h"

namespace penumbra {
namespace {

constexpr int kWidth = 64, kHeight = 48;

FilmImage black() {
  FilmImage image;
  image.width = kWidth;
  image.height = kHeight;
  image.window = {0, 0, kWidth, kHeight};
  image.rgb.assign(3 * image.pixels(), 0.0f);
  image.samples.assign(image.pixels(), 0.0f);
  return image;
}

/// Mean of `passes` draws of N(1, 0.5²) per value, going on from `before`, with the variance of the mean.
struct Noise {
  std::mt19937_64 random{7};
  std::vector<double> sum = std::vector<double>(3 * kWidth * kHeight), squares = sum;
  int64_t done = 0;

  FilmImage render(int64_t passes) {
    std::normal_distribution<double> draw(1, 0.5);
    for (; done < passes; ++done)
      for (size_t i = 0; i < sum.size(); ++i) {
        const double v = draw(random);
        sum[i] += v;
        squares[i] += v * v;
      }
    FilmImage image = black();
    const auto n = static_cast<double>(passes);
    for (size_t i = 0; i < sum.size(); ++i) {
      image.rgb[i] = static_cast<float>(sum[i] / n);
      const double scatter = squares[i] / n - sum[i] * sum[i] / (n * n);
      image.variance.push_back(static_cast<float>(scatter / (n - 1)));
    }
    image.samples.assign(image.pixels(), static_cast<float>(passes));
    return image;
  }
};

TEST(OwnError, IsTheVarianceOverTheSquare) {
  FilmImage image = black();
  image.rgb.assign(image.rgb.size(), 2.0f);
  image.variance.assign(image.rgb.size(), 0.25f);
  image.samples.assign(image.pixels(), 8.0f);
  const auto own = own_error(image);
  ASSERT_TRUE(own.has_value());
  EXPECT_NEAR(own->relmse, 0.25 / 4.01, 1e-12);
  ASSERT_TRUE(own->relmse_ci.has_value());
  EXPECT_NEAR(own->relmse_ci->low, own->relmse, 1e-12);
}

TEST(OwnError, ANoisyPixelDoesNotHideItsNoise) {
  FilmImage image = black();
  image.rgb.assign(image.rgb.size(), 1.0f);
  image.variance.assign(image.rgb.size(), 0.0f);
  const size_t p = image.index(20, 20);
  for (size_t i = 3 * p; i < 3 * p + 3; ++i) image.rgb[i] = 26, image.variance[i] = 100;
  const double around = (24 + 26) / 25.0;
  EXPECT_NEAR(own_error_pixels(image)[p], 100 / (around * around + 0.01), 1e-3);
}

TEST(OwnError, UnknownWhereAPixelHasOneSample) {
  FilmImage image = black();
  EXPECT_FALSE(own_error(image).has_value()) << "no variance layer";
  image.variance.assign(image.rgb.size(), 0.25f);
  image.samples.assign(image.pixels(), 8.0f);
  image.samples[5] = 1;
  EXPECT_FALSE(own_error(image).has_value());
}

TEST(OwnError, AgreesWithTheTruth) {
  Noise noise;
  const FilmImage early = noise.render(16), late = noise.render(64);
  FilmImage truth = black();
  truth.rgb.assign(truth.rgb.size(), 1.0f);
  const double at_16 = compare(early, truth)->relmse, at_64 = compare(late, truth)->relmse;
  // 9,216 values: their mean square scatters by √(2/9216) = 1.5 %; the noisy denominator adds a little.
  EXPECT_NEAR(own_error(late)->relmse / at_64, 1, 0.08);
  EXPECT_NEAR(own_error(early, 16, late, 64)->relmse / at_16, 1, 0.08);
}

TEST(OwnError, OfAnEarlyImageNeedsALaterOne) {
  const FilmImage image = black();
  EXPECT_FALSE(own_error(image, 4, image, 4).has_value());
  EXPECT_FALSE(own_error(image, 0, image, 4).has_value());
  FilmImage other = image;
  other.window = {0, 0, kWidth, kHeight / 2};
  EXPECT_FALSE(own_error(image, 2, other, 4).has_value());
  EXPECT_TRUE(own_error(image, 2, image, 4).has_value());
}

}  // namespace
}  // namespace penumbra
