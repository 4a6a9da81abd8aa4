#include "film/statistics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace penumbra {
namespace {

TEST(Normal, QuantilesOfTables) {
  EXPECT_EQ(normal_quantile(0.5), 0);
  EXPECT_NEAR(normal_quantile(0.975), 1.959963984540054, 1e-14);
  EXPECT_NEAR(normal_quantile(0.995), 2.5758293035489004, 1e-14);
  EXPECT_NEAR(normal_quantile(1e-10), -6.361340902404056, 1e-13);
  EXPECT_NEAR(normal_quantile(1e-300), -37.0471, 1e-4);
}

TEST(Normal, QuantileInvertsTail) {
  for (double log_p = -700; log_p < -0.7; log_p += 0.37) {
    const double p = std::exp(log_p);
    EXPECT_NEAR(normal_tail(-normal_quantile(p)) / p, 1, 1e-11) << p;
  }
}

TEST(Student, QuantilesOfTables) {
  EXPECT_NEAR(t_quantile(0.975, 1), 12.706204736174694, 1e-11);
  EXPECT_NEAR(t_quantile(0.975, 2), 4.302652729749462, 1e-12);
  EXPECT_NEAR(t_quantile(0.975, 15), 2.1314495455597742, 1e-13);
  EXPECT_NEAR(t_quantile(0.95, 30), 1.6972608865939574, 1e-13);
  EXPECT_NEAR(t_quantile(0.025, 15), -2.1314495455597742, 1e-13);
}

TEST(Student, ClosedFormsForOneAndTwoDegrees) {
  for (const double t : {0.1, 1.0, 3.0, 40.0}) {
    EXPECT_NEAR(t_tail(t, 1), 0.5 - std::atan(t) / M_PI, 1e-15);
    EXPECT_NEAR(t_tail(t, 2), 0.5 * (1 - t / std::sqrt(2 + t * t)), 1e-15);
    EXPECT_NEAR(t_tail(-t, 2), 0.5 * (1 + t / std::sqrt(2 + t * t)), 1e-15);
  }
}

TEST(Student, BecomesNormal) {
  EXPECT_NEAR(t_quantile(0.999, 1e7), normal_quantile(0.999), 1e-6);
}

TEST(Sidak, AllTestsTogetherHaveTheLevel) {
  EXPECT_DOUBLE_EQ(sidak(0.05, 1), 0.05);
  EXPECT_NEAR(1 - std::pow(1 - sidak(0.05, 100), 100), 0.05, 1e-14);
  EXPECT_NEAR(sidak(1e-12, 1000), 1e-15, 1e-27);  // would cancel if written as it is defined
}

FilmImage noise_image(int width, int height, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<float> normal(1, 0.5f);
  FilmImage image;
  image.width = width;
  image.height = height;
  image.window = {0, 0, width, height};
  for (size_t i = 0; i < 3 * image.pixels(); ++i) {
    image.rgb.push_back(normal(random));
    image.variance.push_back(0.25f);
  }
  return image;
}

TEST(Blocks, CoverARegionWithMeanAndVariance) {
  const FilmImage image = noise_image(40, 20, 1);
  const auto all = blocks(image, {3, 2, 38, 20});
  ASSERT_EQ(all.size(), 3u * 2u);
  EXPECT_EQ(all[2].rect, (PixelRect{35, 2, 38, 18}));
  EXPECT_EQ(all[5].rect, (PixelRect{35, 18, 38, 20}));
  double sum = 0;
  for (int y = 18; y < 20; ++y)
    for (int x = 35; x < 38; ++x) sum += image.rgb[3 * image.index(x, y) + 1];
  EXPECT_NEAR(all[5].mean[1], sum / 6, 1e-12);
  EXPECT_NEAR(all[5].variance[1], 0.25 / 6, 1e-12);
}

TEST(ZTest, AcceptsEqualMeansAndRejectsAShift) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  std::vector<double> a, b, variance;
  for (int i = 0; i < 2000; ++i) {
    const double s = 0.1 * (1 + i % 7);
    a.push_back(3 + s * normal(random));
    b.push_back(3 + s * normal(random));
    variance.push_back(2 * s * s);
  }
  const ZTest same = z_test(a, b, variance, 0.01);
  EXPECT_TRUE(same.passes()) << same.largest;
  EXPECT_EQ(same.compared, 2000);
  EXPECT_NEAR(same.threshold, 4.56, 0.01);  // Šidák: 0.01 over 2000, two-sided
  a[700] += 8 * std::sqrt(variance[700]);
  const ZTest moved = z_test(a, b, variance, 0.01);
  EXPECT_GE(moved.rejected, 1);
  EXPECT_EQ(moved.worst, 700);
}

TEST(ZTest, FalseAlarmsComeAtTheLevel) {
  std::mt19937 random(11);
  std::normal_distribution<double> normal;
  const std::vector<double> zero(50, 0), one(50, 1);
  int alarms = 0;
  constexpr int kTrials = 4000;
  for (int t = 0; t < kTrials; ++t) {
    std::vector<double> a(50);
    for (double& v : a) v = normal(random);
    alarms += !z_test(a, zero, one, 0.05).passes();
  }
  // Binomial(4000, 0.05): 200 ± 13.8; four of them.
  EXPECT_NEAR(alarms, 200, 56);
}

TEST(ZTest, ZeroVarianceMeansEqual) {
  const std::vector<double> a = {1, 0}, zero = {0, 0};
  EXPECT_TRUE(z_test(a, std::vector<double>{1 + 1e-7, 0}, zero, 0.05).passes());
  EXPECT_FALSE(z_test(a, std::vector<double>{1.1, 0}, zero, 0.05).passes());
  EXPECT_FALSE(z_test(std::vector<double>{std::nan(""), 0}, a, std::vector<double>{1, 1}, 0.05).passes());
}

TEST(PowerLaw, RecoversASlopeWithinItsInterval) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal(0, 0.1);
  int covered = 0;
  constexpr int kTrials = 1000;
  for (int t = 0; t < kTrials; ++t) {
    std::vector<double> x, y;
    for (int i = 0; i < 8; ++i) {
      x.push_back(std::pow(2, i));
      y.push_back(3 * std::pow(x.back(), -1.5) * std::exp(normal(random)));
    }
    const auto law = fit_power_law(x, y);
    ASSERT_TRUE(law.has_value());
    covered += law->ci.low <= -1.5 && -1.5 <= law->ci.high;
  }
  EXPECT_NEAR(covered, 950, 28);  // Binomial(1000, 0.95): ± 6.9; four of them
}

TEST(PowerLaw, ExactDataGiveAnExactLaw) {
  const std::vector<double> x = {1, 10, 100}, y = {5, 0.5, 0.05};
  const auto law = fit_power_law(x, y);
  ASSERT_TRUE(law.has_value());
  EXPECT_NEAR(law->slope, -1, 1e-14);
  EXPECT_NEAR(std::exp(law->intercept), 5, 1e-13);
  EXPECT_LT(law->ci.high - law->ci.low, 1e-12);
}

TEST(PowerLaw, RefusesWhatHasNoSlope) {
  EXPECT_FALSE(fit_power_law(std::vector<double>{1, 2}, std::vector<double>{1, 2}).has_value());
  EXPECT_FALSE(fit_power_law(std::vector<double>{1, 2, 0}, std::vector<double>{1, 2, 3}).has_value());
  EXPECT_FALSE(fit_power_law(std::vector<double>{7, 7, 7}, std::vector<double>{1, 2, 3}).has_value());
  const double inf = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(fit_power_law(std::vector<double>{1, 2, 3}, std::vector<double>{1, 2, inf}).has_value());
}

}  // namespace
}  // namespace penumbra
