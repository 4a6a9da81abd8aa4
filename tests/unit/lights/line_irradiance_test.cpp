#include "worker/lights/line_irradiance.h"

#include <gtest/gtest.h>

#include <cmath>

#include "worker/lights/chords.h"
#include "worker/lights/irradiance.h"

namespace penumbra {
namespace {

LightLine line(const Vec3d& a, const Vec3d& b, const Vec3d& n) {
  LightLine l;
  l.corner = l.a = a;
  l.along = b - a;
  l.b = b;
  l.n = n;
  l.scale = 1;
  return l;
}

/// The integral by its definition, with many small steps.
double stepped(const LightLine& l, const Vec3d& x, const Vec3d& n, double lo, double hi) {
  constexpr int kSteps = 200000;
  double sum = 0;
  for (int i = 0; i < kSteps; ++i) {
    const double s = lo + (hi - lo) * (i + 0.5) / kSteps;
    const Vec3d d = l.a + s * l.along - x;
    const double r2 = d.length2();
    sum += std::abs(n.dot(d)) * std::max(0.0, -l.n.dot(d)) / (r2 * r2);
  }
  return sum * (hi - lo) * l.along.length() / kSteps;
}

TEST(LineIrradiance, IsTheIntegralAlongTheLine) {
  const Vec3d n(0, 0, 1), down(0, 0, -1), tilted = Vec3d(0.3, -0.2, 1).normalized();
  const Vec3d side = Vec3d(0, 0.6, -0.8);
  struct {
    LightLine l;
    Vec3d n;
    double lo, hi;
  } const cases[] = {
      {line({-3, 0.5, 1}, {4, 0.2, 1}, down), n, 0, 1},
      {line({-3, 0.5, 1}, {4, 0.2, 1}, down), tilted, 0.1, 0.8},
      {line({-30, 0, 0.1}, {40, 0, 0.1}, down), n, 0.6, 0.61},
      {line({2, 0, 1}, {2.01, 0, 1}, down), tilted, 0, 1},
      {line({-1, -3, -0.5}, {2, 1, 2.5}, side), tilted, 0, 1},  // crosses the horizon
  };
  for (const auto& c : cases) {
    const double exact = stepped(c.l, {0, 0, 0}, c.n, c.lo, c.hi);
    EXPECT_NEAR(line_irradiance(c.l, {0, 0, 0}, c.n, c.lo, c.hi) / exact, 1, 1e-8);
  }
}

TEST(LineIrradiance, PartsAddUpWhereverTheFormulaChanges) {
  const LightLine l = line({-3, 0.5, 1}, {4, 0.2, 1}, {0, 0, -1});
  const Vec3d n = Vec3d(0.3, -0.2, 1).normalized(), x(0, 0, 0);
  for (double at : {0.01, 0.1, 0.2, 0.4, 0.5, 0.7, 0.99}) {
    const double whole = line_irradiance(l, x, n, 0, 1);
    EXPECT_NEAR(line_irradiance(l, x, n, 0, at) + line_irradiance(l, x, n, at, 1), whole, 1e-11 * whole);
  }
}

TEST(LineIrradiance, ChordsOfALightAddUpToItsIrradiance) {
  const Vec3d x(0.1, 0.2, 0.3), n(0, 0, 1);
  const LightShape shapes[] = {QuadShape{{-1, -0.5f, 2}, {0, 1.5f, 0}, {2, 0, 0.3f}},
                               TriangleShape{{-1, -0.5f, 2}, {-0.5f, 1.5f, 1.5f}, {2, 0, 2}}};
  for (const LightShape& shape : shapes)
    for (const double radians : {0.0, 0.7, 1.6}) {
      // The mean of (line integral / density of its offset) over the quantiles of the offset.
      const ParallelChords chords(shape, radians);
      constexpr int kLines = 4000;
      double sum = 0;
      for (int i = 0; i < kLines; ++i) {
        const LightLine l = chords.choose((i + 0.5) / kLines);
        sum += line_irradiance(l, x, n, 0, 1) / (l.scale * l.along.length());
      }
      EXPECT_NEAR(sum / kLines / irradiance(shape, x, n), 1, 1e-5);
    }
}

TEST(LineIrradiance, ALineSeenFromBehindIsDark) {
  EXPECT_EQ(line_irradiance(line({-1, 0, 1}, {1, 0, 1}, {0, 0, 1}), {0, 0, 0}, {0, 0, 1}, 0, 1), 0);
}

}  // namespace
}  // namespace penumbra
