#include "worker/lights/light_tree.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace penumbra {
namespace {

std::vector<AreaEmitter> random_triangles(int n, uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> in(-10, 10), edge(-0.3f, 0.3f), level(0, 4);
  std::vector<AreaEmitter> all;
  for (int i = 0; i < n; ++i) {
    AreaEmitter e;
    const Vec3f p(in(random), in(random), in(random));
    const Vec3f u(edge(random), edge(random), edge(random)), v(edge(random), edge(random), edge(random));
    e.shape = TriangleShape{p, p + u, p + v};
    e.radiance = Rgb(std::exp(level(random)));
    all.push_back(e);
  }
  return all;
}

std::vector<LightBounds> bounds(const std::vector<AreaEmitter>& emitters) {
  std::vector<LightBounds> all;
  for (const AreaEmitter& e : emitters) all.push_back(bounds_of(e));
  return all;
}

const Receiver kReceivers[] = {{{0, 0, 0}, true, {0, 0, 1}},
                               {{9, -9, 3}, true, {0.6, 0, -0.8}},
                               {{40, 0, 0}, true, {-1, 0, 0}},
                               {{1, 2, 3}, false, {0, 0, 1}}};

TEST(LightTree, ProbabilitiesAreThoseOfTheDraws) {
  for (const int n : {1, 2, 3, 17, 300}) {
    const auto emitters = random_triangles(n, uint32_t(n));
    const LightTree tree(bounds(emitters));
    for (const Receiver& r : kReceivers) {
      double sum = 0;
      for (size_t l = 0; l < emitters.size(); ++l) sum += tree.probability(r, l);
      const bool any = tree.importance(r) > 0;
      EXPECT_LE(sum, any ? 1 + 1e-12 : 0);
      // The quantiles are cut into as many intervals as there are lights: each as long as it is likely.
      constexpr int kDraws = 20000;
      std::vector<int> hits(emitters.size());
      int empty = 0;
      for (int i = 0; i < kDraws; ++i) {
        const DrawnLight drawn = tree.draw(r, (i + 0.5) / kDraws);
        if (!(drawn.probability > 0)) {
          ++empty;
          continue;
        }
        ++hits[drawn.light];
        EXPECT_NEAR(drawn.probability / tree.probability(r, drawn.light), 1, 1e-12);
      }
      for (size_t l = 0; l < emitters.size(); ++l)
        EXPECT_NEAR(hits[l], kDraws * tree.probability(r, l), 2) << l;
      // That no light of a subtree can arrive may be found out only there: such draws end without a light.
      EXPECT_NEAR(empty, kDraws * (1 - sum), 2.0 * n);
    }
  }
}

TEST(LightTree, ALightThatCanArriveIsNeverImpossible) {
  const auto emitters = random_triangles(500, 7);
  const LightTree tree(bounds(emitters));
  std::mt19937 random(8);
  std::uniform_real_distribution<double> in(-11, 11), unit(-1, 1);
  for (int i = 0; i < 200; ++i) {
    const Vec3d x(in(random), in(random), in(random)),
        n = Vec3d(unit(random), unit(random), unit(random)).normalized();
    for (size_t l = 0; l < emitters.size(); ++l) {
      const auto& t = std::get<TriangleShape>(emitters[l].shape);
      bool arrives = false;
      for (const Vec3f& p : {t.p0, t.p1, t.p2, (t.p0 + t.p1 + t.p2) / 3.0f})
        arrives |=
            (Vec3d(p) - x).dot(n) > 0 && (x - Vec3d(p)).dot(emission_normal(emitters[l].shape, Vec3d(p))) > 0;
      if (arrives) {
        EXPECT_GT(tree.probability({x, true, n}, l), 0) << l;
      }
    }
  }
}

TEST(LightTree, FindsTheNearAndTheBright) {
  const auto emitters = random_triangles(2000, 3);
  const LightTree tree(bounds(emitters));
  // Σ contribution² / probability over the square of the sum: 1 for perfect draws. Against draws by power.
  double total_power = 0;
  for (const AreaEmitter& e : emitters) total_power += bounds_of(e).power;
  const Receiver r{{0, 0, 0}, true, {0, 0, 1}};
  double sum = 0, by_tree = 0, by_power = 0;
  for (size_t l = 0; l < emitters.size(); ++l) {
    const double c = importance(bounds_of(emitters[l]), r);
    if (!(c > 0)) continue;
    sum += c;
    by_tree += c * c / tree.probability(r, l);
    by_power += c * c / (bounds_of(emitters[l]).power / total_power);
  }
  EXPECT_LT(by_tree / (sum * sum), 0.2 * by_power / (sum * sum));
}

TEST(NormalCone, AJoinHoldsBoth) {
  std::mt19937 random(2);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> unit(-1, 1);
  for (int i = 0; i < 2000; ++i) {
    const auto axis = [&] { return Vec3d(normal(random), normal(random), normal(random)).normalized(); };
    const NormalCone a{axis(), i % 3 == 0 ? 1 : unit(random)}, b{axis(), i % 5 == 0 ? 1 : unit(random)},
        j = join(a, b);
    for (const NormalCone& c : {a, b}) {
      const double between = std::acos(std::clamp(c.axis.dot(j.axis), -1.0, 1.0));
      if (j.cos_spread > -1) {
        EXPECT_LE(between + std::acos(c.cos_spread), std::acos(j.cos_spread) + 1e-6);
      }
    }
  }
}

}  // namespace
}  // namespace penumbra
