#include "worker/lights/arc.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "worker/lights/line.h"

namespace penumbra {
namespace {

constexpr double kPi = std::numbers::pi;

double parameter(double angle) {
  return std::sin(angle) / (std::sin(angle) + std::cos(angle));
}

TEST(Arc, DifferencesKeepTheirDigits) {
  for (const double lo : {0.0, 1e-9, 0.1, 0.5, 0.999})
    for (const double length : {1e-12, 1e-6, 1e-3}) {
      const double hi = lo + length;
      // In extended precision, with the exact differences of the inputs.
      const auto squared_sine = [](long double s) { return s * s / (s * s + (1 - s) * (1 - s)); };
      const auto cosine = [](long double s) { return (1 - s) / std::sqrt(s * s + (1 - s) * (1 - s)); };
      // The reference itself cancels: its values are right to 2^-63.
      const long double sines = squared_sine(hi) - squared_sine(lo), cosines = cosine(lo) - cosine(hi);
      constexpr double kReference = 0x1p-62, kOwn = 8 * 0x1p-53;
      EXPECT_NEAR(squared_sine_difference(lo, hi), double(sines), kReference + kOwn * double(sines))
          << lo << " " << length;
      EXPECT_NEAR(cosine_difference(lo, hi), double(cosines), kReference + kOwn * double(cosines))
          << lo << " " << length;
    }
  EXPECT_DOUBLE_EQ(squared_sine_difference(0, 1), 1);
  EXPECT_DOUBLE_EQ(cosine_difference(0, 1), 1);
}

ArcTable random_table(int width, int height, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<double> values;
  for (int i = 0; i < width * height; ++i)
    values.push_back(i % 3 == 0 ? 0 : std::exponential_distribution<double>()(random));
  values[size_t(width * height / 2)] = 1e5;
  return ArcTable(width, height, values);
}

class ArcTables : public testing::TestWithParam<std::pair<int, int>> {};

TEST_P(ArcTables, SamplesInvertTheMeasureOnAnyPart) {
  const auto [width, height] = GetParam();
  const ArcTable table = random_table(width, height, 3);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform;
  for (int i = 0; i < 2000; ++i) {
    const ArcTable::Meridian m = table.choose(uniform(random));
    double lo = uniform(random), hi = uniform(random);
    if (lo > hi) std::swap(lo, hi);
    if (i % 3 == 0) lo = 0;
    if (i % 3 == 1) hi = 1;
    const double measure = table.measure(m, lo, hi), v = uniform(random);
    if (!(measure > 0)) continue;
    const double s = table.sample(m, lo, hi, v);
    EXPECT_GE(s, lo);
    EXPECT_LE(s, hi);
    EXPECT_NEAR(table.measure(m, lo, s) / measure, v, 1e-9);
    EXPECT_GT(table.value_at(m, s), 0);
  }
}

/// The density of meridian and point together, per solid angle, is value / total: compared with counts in the
/// cells.
TEST_P(ArcTables, MeridiansAndPointsFallIntoCellsByTheirValues) {
  const auto [width, height] = GetParam();
  std::mt19937 random(7);
  std::vector<double> values;
  for (int i = 0; i < width * height; ++i)
    values.push_back(0.2 + std::uniform_real_distribution<double>()(random));
  const ArcTable table(width, height, values);
  std::vector<double> counts(values.size(), 0);
  std::uniform_real_distribution<double> uniform;
  constexpr int kSamples = 200000;
  for (int i = 0; i < kSamples; ++i) {
    const ArcTable::Meridian m = table.choose(uniform(random));
    const double s = table.sample(m, 0, 1, uniform(random));
    ++counts[size_t(table.row_at(m, s)) * size_t(width) + size_t(m.column)];
  }
  double total = 0;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const size_t c = size_t(y) * size_t(width) + size_t(x);
      const double solid_angle =
          (std::cos(kPi * y / height) - std::cos(kPi * (y + 1) / height)) * 2 * kPi / width;
      const double expected = kSamples * values[c] * solid_angle / table.total();
      total += values[c] * solid_angle;
      EXPECT_NEAR(counts[c], expected, 5 * std::sqrt(expected) + 1) << x << " " << y;
    }
  EXPECT_NEAR(total / table.total(), 1, 1e-12);
}

INSTANTIATE_TEST_SUITE_P(Sizes, ArcTables,
                         testing::Values(std::pair{1, 1}, std::pair{1, 2}, std::pair{3, 3}, std::pair{8, 4},
                                         std::pair{5, 7}, std::pair{64, 32}));

TEST(Arc, TheLineThroughAPointHoldsIt) {
  const ArcTable table = random_table(16, 8, 2);
  const Vec3d x(3, -2, 5);
  for (const Vec3d& direction : {Vec3d(0.3, 0.4, 0.5), Vec3d(-1, 0.1, -0.2), Vec3d(0, 0, 1), Vec3d(0, 0, -1),
                                 Vec3d(1, 0, 0), Vec3d(-1, -1e-17, 0)}) {
    const Vec3d w = direction.normalized();
    const ArcTable::Meridian m = table.through(w);
    const ArcMeasure measure{&table, m, table.measure(m, 0, 1)};
    const LightLine line =
        arc_line(x, {0, 0, m.lower ? -1.0 : 1.0}, {std::cos(m.phi), std::sin(m.phi), 0}, 100, measure, 1);
    const double s = parameter_of(line, x + 7.0 * w);
    const Vec3d back = (line.from + s * line.along).normalized();
    EXPECT_NEAR((back - w).length(), 0, 1e-12) << w;
  }
}

TEST(Arc, ByTheCosineIsTheSquaredSine) {
  const ArcMeasure cosine;
  EXPECT_NEAR(relative_measure_of(cosine, parameter(0.3), parameter(0.7)),
              std::pow(std::sin(0.7), 2) - std::pow(std::sin(0.3), 2), 1e-14);
  for (const double v : {0.0, 1e-6, 0.3, 0.9999})
    EXPECT_NEAR(squared_sine_difference(0.2, sample_within_measure(cosine, 0.2, 0.9, v)),
                v * squared_sine_difference(0.2, 0.9), 1e-14);
  EXPECT_EQ(sample_within_measure(cosine, 0, 1, 0), 0);
  EXPECT_NEAR(sample_within_measure(cosine, 0, 1, 1), 1, 1e-15);
}

}  // namespace
}  // namespace penumbra
