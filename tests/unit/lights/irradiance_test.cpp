#include "worker/lights/irradiance.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "worker/lights/convex_polygon.h"
#include "worker/sampling/hash.h"
#include "worker/sampling/sampler.h"

namespace penumbra {
namespace {

const QuadShape kQuad{{-1, -0.5f, 0}, {2, 0, 0}, {0, 1, 0}};

TEST(ConvexPolygon, ClipKeepsWhatLiesAbove) {
  const ConvexPolygon square = {{0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
  EXPECT_EQ(clip(square, {0, 0, 1}).corners().size(), 4u);
  EXPECT_TRUE(clip(square, {0, 0, -1}).empty());
  EXPECT_EQ(clip(square, {1, 1, 0}, 0.5).corners().size(), 5u);
  EXPECT_EQ(clip(square, {1, 0, 0}, 0.5).corners().size(), 4u);
}

TEST(Irradiance, OfAHugeCeilingIsPi) {
  const float size = 1e6f;
  const LightShape ceiling = QuadShape{{-size, -size, 1}, {0, 2 * size, 0}, {2 * size, 0, 0}};
  EXPECT_NEAR(irradiance(ceiling, {0, 0, 0}, {0, 0, 1}), std::numbers::pi, 1e-11);
}

TEST(Irradiance, FromBehindAndBelowTheHorizonIsZero) {
  EXPECT_EQ(irradiance(kQuad, {0, 0, -1}, {0, 0, 1}), 0);
  EXPECT_EQ(irradiance(kQuad, {0, 0, 1}, {0, 0, 1}), 0);
  EXPECT_GT(irradiance(kQuad, {0, 0, 1}, {0, 0, -1}), 0);
  EXPECT_FALSE(has_irradiance(SphereShape{{0, 0, 0}, 1}));
}

TEST(Irradiance, AgreesWithSamplesOfTheSolidAngle) {
  // E = Ω · mean of max(0, n·ω), the horizon across the light.
  const LightShape triangle = TriangleShape{{-1, -0.5f, 0}, {1, -0.5f, 0}, {0.2f, 1, 0.3f}};
  const Vec3d x(0.2, 0.3, 0.8), n = Vec3d(0.8, 0.1, -0.3).normalized();
  for (const LightShape& shape : {LightShape(kQuad), triangle}) {
    const SeenShape seen(shape, x);
    double sum = 0, square = 0;
    constexpr int kSamples = 100000;
    for (int i = 0; i < kSamples; ++i) {
      const LightPoint p = seen.sample({uniform(mix64(2 * i)), uniform(mix64(2 * i + 1))});
      const double f = std::max(0.0, n.dot((p.p - x).normalized())) / p.pdf;
      sum += f;
      square += f * f;
    }
    const double mean = sum / kSamples, error = std::sqrt((square / kSamples - mean * mean) / kSamples);
    EXPECT_NEAR(irradiance(shape, x, n), mean, 5 * error);
  }
}

TEST(Irradiance, QuartersAddUpAcrossTheChangeOfMethod) {
  // From size/distance far above 0.02 to far below, so that whole and quarters take different methods.
  const Vec3d n = Vec3d(0.2, 0.3, -1).normalized();
  for (const double distance : {1.0, 10.0, 60.0, 90.0, 112.0, 120.0, 200.0, 1e4, 1e6}) {
    const Vec3d x(0.3 * distance, 0.1, distance);
    const double whole = irradiance(kQuad, x, n);
    double sum = 0;
    for (const float i : {0.0f, 1.0f})
      for (const float j : {0.0f, 1.0f})
        sum += irradiance(
            QuadShape{kQuad.o + i * 0.5f * kQuad.u + j * 0.5f * kQuad.v, 0.5f * kQuad.u, 0.5f * kQuad.v}, x,
            n);
    EXPECT_NEAR(sum / whole, 1, 2e-13) << distance;
  }
}

TEST(IrradianceBehind, FullNoAndHalfCover) {
  const Vec3d x(0.1, 0.2, 2), n(0, 0, -1);
  const double whole = irradiance(kQuad, x, n);
  EXPECT_NEAR(irradiance_behind(kQuad, x, n, {Vec3d(-9, -9, 1), Vec3d(9, -9, 1), Vec3d(0, 20, 1)}), 0, 1e-16);
  // Behind x, beyond the light, edge-on, beside.
  EXPECT_DOUBLE_EQ(irradiance_behind(kQuad, x, n, {Vec3d(-9, -9, 3), Vec3d(9, -9, 3), Vec3d(0, 20, 3)}),
                   whole);
  EXPECT_DOUBLE_EQ(irradiance_behind(kQuad, x, n, {Vec3d(-9, -9, -1), Vec3d(9, -9, -1), Vec3d(0, 20, -1)}),
                   whole);
  EXPECT_DOUBLE_EQ(irradiance_behind(kQuad, x, n, {Vec3d(0.1, -9, 1), Vec3d(0.1, 9, 1), Vec3d(0.1, 0, -5)}),
                   whole);
  EXPECT_DOUBLE_EQ(irradiance_behind(kQuad, x, n, {Vec3d(5, 5, 1), Vec3d(6, 5, 1), Vec3d(5, 6, 1)}), whole);
  // The half-plane right of x's own vertical plane: what is left is the quad's left part.
  const double left =
      irradiance_behind(kQuad, x, n, {Vec3d(0.1, -99, 1), Vec3d(99, 0, 1), Vec3d(0.1, 99, 1)});
  const double left_part = irradiance(QuadShape{kQuad.o, {1.1f, 0, 0}, kQuad.v}, x, n);
  EXPECT_NEAR(left / left_part, 1, 1e-6);  // 1.1 in single precision
}

TEST(IrradianceBehind, LitAndShadowedPartsAddUp) {
  // A triangle inside the light's cone, in either orientation; its shadow alone is a light of three corners.
  const Vec3d x(0, 0, 2), n = Vec3d(0.1, 0.2, -1).normalized();
  const std::array<Vec3d, 3> blocker = {Vec3d(-0.2, -0.1, 1), Vec3d(0.2, -0.1, 1), Vec3d(0, 0.15, 1)};
  const std::array<Vec3d, 3> reversed = {blocker[2], blocker[1], blocker[0]};
  const LightShape shadow = TriangleShape{{-0.4f, -0.2f, 0}, {0.4f, -0.2f, 0}, {0, 0.3f, 0}};
  const double expected = irradiance(kQuad, x, n) - irradiance(shadow, x, n);
  EXPECT_NEAR(irradiance_behind(kQuad, x, n, blocker), expected, 1e-7);
  EXPECT_NEAR(irradiance_behind(kQuad, x, n, reversed), expected, 1e-7);
}

}  // namespace
}  // namespace penumbra
