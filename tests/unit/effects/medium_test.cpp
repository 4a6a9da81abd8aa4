// A medium's closed forms where they are hard: optical depths from 1e-8 to 1e4, rays without end, pivots on
// the ray's line.
#include "worker/effects/medium.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

namespace penumbra {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

Medium medium_of(double sigma_t, double sigma_s) {
  Medium m;
  m.sigma_t = Vec3d(sigma_t);
  m.sigma_s = Vec3d(sigma_s);
  return m;
}

/// ∫ of a density over [t0,t1] by midpoints in the number that samples it is 1 only if both agree; here by
/// substitution: ∫ pdf dt = Σ pdf(t_i) Δt_i.
double total(const std::function<double(double)>& t_of, const std::function<double(double)>& pdf) {
  constexpr int kSteps = 20000;
  double sum = 0;
  for (int i = 0; i < kSteps; ++i) {
    const double a = t_of(double(i) / kSteps), b = t_of((i + 1.0) / kSteps);
    sum += (b - a) * (pdf(a) + 4 * pdf(0.5 * (a + b)) + pdf(b)) / 6;
  }
  return sum;
}

TEST(Transmittance, IsOneWithoutExtinctionHoweverFar) {
  EXPECT_EQ(transmittance(medium_of(0, 0), kInfinity), Vec3d(1));
  EXPECT_EQ(transmittance(medium_of(1e-30, 0), kInfinity), Vec3d(0));
}

TEST(FreeFlight, SamplesFollowTheDensityAtEveryOpticalDepth) {
  for (const double depth : {1e-8, 1e-4, 0.1, 1.0, 30.0, 1e4}) {
    const Medium m = medium_of(depth / 2, depth / 4);
    const MediumRay ray{Vec3d(0), Vec3d(0, 0, 1), 3, 5};
    const FreeFlight flight(m, ray);
    ASSERT_TRUE(flight.possible());
    const auto t_of = [&](double u) { return flight.sample(std::min(u, 1 - 0x1p-53), 0).t; };
    const auto pdf = [&](double t) { return flight.pdf(flight.point(t)); };
    EXPECT_NEAR(total(t_of, pdf), 1, 2e-4) << depth;
    double last = ray.t0;
    for (int i = 0; i < 100; ++i) {
      const double t = t_of(i / 100.0);
      EXPECT_TRUE(t >= last && t <= ray.t1) << depth << " " << t;
      last = t;
    }
    // u is the share of the scattered light before t: the known integral, by long double.
    const double u = 0.37, s = t_of(u) - ray.t0;
    const long double share =
        -std::expm1(-(long double)(m.sigma_t.x) * s) / -std::expm1(-(long double)(depth));
    EXPECT_NEAR(double(share), u, 1e-14 * std::max(1.0, 5 / s)) << depth;
  }
}

TEST(FreeFlight, WithoutEnd) {
  const Medium m = medium_of(2, 1), absorbs = medium_of(2, 0);
  const FreeFlight flight(m, {Vec3d(0), Vec3d(0, 0, 1), 1, kInfinity});
  const ScatterPoint at = flight.sample(0.5, 0.9);
  EXPECT_DOUBLE_EQ(at.t, 1 + std::log(2.0) / 2);
  EXPECT_DOUBLE_EQ(flight.pdf(at), 2 * 0.5);
  EXPECT_FALSE(FreeFlight(absorbs, {Vec3d(0), Vec3d(0, 0, 1), 0, 1}).possible());
}

TEST(FreeFlight, ChannelsThatDoNotScatterAreNotDrawn) {
  Medium m;
  m.sigma_t = {1, 100, 0};
  m.sigma_s = {1, 0, 0};
  const FreeFlight flight(m, {Vec3d(0), Vec3d(0, 0, 1), 0, 1});
  for (const double choice : {0.0, 0.5, 0.999}) {
    const ScatterPoint at = flight.sample(0.5, choice);
    EXPECT_NEAR(at.t, -std::log1p(0.5 * std::expm1(-1.0)), 1e-15);
    EXPECT_NEAR(flight.pdf(at), std::exp(-at.t) / -std::expm1(-1.0), 1e-15);
  }
}

TEST(Equiangular, SamplesFollowTheDensity) {
  for (const Vec3d& pivot :
       {Vec3d(1, 0, 4), Vec3d(0.01, 0, 4), Vec3d(0, 1e4, 0), Vec3d(0.3, 0, -50), Vec3d(2, 1, 90)}) {
    const Equiangular angle({Vec3d(0), Vec3d(0, 0, 1), 3, 5}, pivot);
    ASSERT_TRUE(angle.possible());
    EXPECT_NEAR(total([&](double u) { return angle.sample(u); }, [&](double t) { return angle.pdf(t); }), 1,
                1e-6);
    EXPECT_EQ(angle.sample(0), 3);
    EXPECT_NEAR(angle.sample(1), 5, 1e-9);
    EXPECT_LE(angle.sample(1), 5);
  }
}

TEST(Equiangular, WithoutEndAndOnTheLine) {
  const Equiangular open({Vec3d(0), Vec3d(0, 0, 1), 0, kInfinity}, Vec3d(1, 0, 0));
  EXPECT_NEAR(open.sample(0.5), 1, 1e-15);
  EXPECT_TRUE(std::isfinite(open.sample(1)));
  EXPECT_FALSE(Equiangular({Vec3d(0), Vec3d(0, 0, 1), 0, 1}, Vec3d(0, 0, 0.5)).possible());
  EXPECT_FALSE(Equiangular({Vec3d(0), Vec3d(0, 0, 1), 1, 1}, Vec3d(1, 0, 0.5)).possible());
}

}  // namespace
}  // namespace penumbra
