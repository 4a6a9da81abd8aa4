// The weights of a mix at points of a light that is partly hidden: a partition of unity, the same whichever
// strategy found the point.
#include <gtest/gtest.h>

#include <numeric>

#include "tests/support/render.h"
#include "tests/support/shading.h"
#include "worker/strategies/smoothing.h"

namespace penumbra {
namespace {

/// A floor, a light above it and, between them, two bars and a sliver.
const char* const kScene = R"(LookAt 0 3 6  0 0.5 0  0 1 0
Camera "perspective" "float fov" 40
WorldBegin
AttributeBegin
AreaLightSource "diffuse" "rgb L" [ 5 5 5 ]
Shape "quad" "point o" [ -0.7 2.2 -0.5 ] "vector u" [ 1.4 0 0 ] "vector v" [ 0 0 0.9 ]
AttributeEnd
Material "plastic" "float roughness" 0.2
Shape "trianglemesh" "integer indices" [ 0 1 2 0 2 3 ] "point P" [ -4 0 -4  -4 0 4  4 0 4  4 0 -4 ]
Shape "trianglemesh" "integer indices" [ 0 1 2  0 2 3 ] "point P" [ -1 1 -0.2  1 1 -0.1  1 1 0  -1 1 0 ]
Shape "trianglemesh" "integer indices" [ 0 1 2  0 2 3 ] "point P" [ 0.1 1.1 -1  0.2 1.1 -1  0.4 1.1 1  0.1 1.1 1 ]
Shape "trianglemesh" "integer indices" [ 0 1 2 ] "point P" [ -0.3 0.9 -1  -0.29 0.9 1  -0.31 0.9 1 ]
)";

const Vec3f kEye(0, 3, 6);
const Vec3f kTargets[] = {{0, 0, 0}, {0.4f, 0, 0.1f}, {-0.3f, 0, -0.4f}, {1.5f, 0, 0.3f}, {0, 0, 1}};

class Weights : public ::testing::Test {
 protected:
  const ScenePtr scene_ = test::load_text(kScene);
  QueryCounters counters_;

  /// Calls visit(shading point) for each target.
  template <class Visit>
  void at_each_target(const Visit& visit) {
    ASSERT_TRUE(scene_);
    for (const Vec3f& target : kTargets) {
      const test::Met met(*scene_, kEye, target - kEye);
      ASSERT_TRUE(bool(met));
      visit(met.point());
    }
  }
};

TEST_F(Weights, SumToOneAtEveryPointThatIsSeen) {
  int seen = 0, smoothed = 0;
  for (const char* text :
       {"bsdf:1+line-sa@u:2", "bsdf:3+sa:1+line-sa@v:1/power", "bsdf:1+area:2+line-area@30:1/free",
        "bsdf:1+line-sa@u:1/average", "bsdf:2+line-sa@u:1/smooth=0.3",
        "sa:1+line-sa@u:1+line-sa@v:3/smooth=auto", "bsdf:1+line-area@40:1/smooth-ease=0.1",
        "bsdf:1+area:1+line-area@0:1+line-sa@u:1/smooth-ease=auto", "bsdf:1+visible-area:3",
        "sa:1+visible-area:1+line-sa@v:1/power"}) {
    const Mix mix = parse_mix(text).value();
    const PreparedMix prepared(mix, scene_->lights);
    DirectLight direct({*scene_->geometry, scene_->lights}, prepared, counters_);
    at_each_target([&](const ShadingPoint& point) {
      for (double i = 0.5; i < 40; ++i)
        for (double j = 0.5; j < 20; ++j) {
          const auto at = direct.integrand(point, 0, {-0.7 + 1.4 * i / 40, 2.2, -0.5 + 0.9 * j / 20});
          if (at.f == Rgb(0)) continue;
          ++seen;
          if (at.smoothing < 1) ++smoothed;
          EXPECT_NEAR(std::accumulate(at.weights.begin(), at.weights.end(), 0.0), 1, 1e-14) << text;
        }
    });
  }
  EXPECT_GT(seen, 1000);
  EXPECT_GT(smoothed, 1000);
}

TEST_F(Weights, SmoothingOfALineIsThatOfTheLineThroughItsPoint) {
  // Interval ends are single precision, of the chord's parameter.
  const double rounding = 1.5 / 0.1 * 64 * std::numeric_limits<float>::epsilon();
  const Smoothing smoothing{SmoothShape::kCubic, 0.1};
  int below = 0;
  for (const StrategyKind kind :
       {StrategyKind::kLineSolidAngleU, StrategyKind::kLineSolidAngleV, StrategyKind::kLineArea}) {
    const AreaEmitter& light = scene_->lights.area[0];
    const Strategy strategy = fit({kind, 25, 1}, light);
    at_each_target([&](const ShadingPoint& point) {
      const LightView view(point, light);
      for (double u = 0.5 / 16; u < 1; u += 1.0 / 16) {
        LineBatch own, through;
        own.add(choose_line(strategy, view, u), point, &light);
        own.trace(*scene_->geometry, nullptr, counters_);
        for (double s = 0.5 / 32; s < 1; s += 1.0 / 32) {
          const LightLine& l = own.line(0);
          through.clear();
          through.add(line_through(strategy, view, l.a + s * (l.b - l.a)), point, &light);
          through.trace(*scene_->geometry, nullptr, counters_);
          const double a = line_factor(smoothing, l, own.visible(0), s);
          const double b = line_factor(smoothing, through.line(0), through.visible(0),
                                       parameter_of(through.line(0), l.a + s * (l.b - l.a)));
          EXPECT_NEAR(a, b, rounding);
          if (a > 0 && a < 1) ++below;
        }
      }
    });
  }
  EXPECT_GT(below, 100);
}

TEST_F(Weights, SmoothedDensitiesVanishAtTheEdgeOfAShadow) {
  const Mix mix = parse_mix("bsdf:1+line-sa@u:1/smooth=0.2").value();
  const PreparedMix prepared(mix, scene_->lights);
  DirectLight direct({*scene_->geometry, scene_->lights}, prepared, counters_);
  at_each_target([&](const ShadingPoint& point) {
    // Along a chord in small steps, the weight of bsdf must not jump where the light disappears.
    bool was_seen = false;
    double last = 0;
    for (double i = 0.5; i < 4000; ++i) {
      const auto at = direct.integrand(point, 0, {-0.7 + 1.4 * i / 4000, 2.2, -0.3});
      const bool seen = at.f != Rgb(0);
      const double weight = seen ? at.weights[0] : 0;
      if (i > 1 && seen != was_seen) {
        EXPECT_LT(std::max(weight, last), 0.02) << i;
      }
      was_seen = seen;
      last = weight;
    }
  });
}

}  // namespace
}  // namespace penumbra
