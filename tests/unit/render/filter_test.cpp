#include "worker/render/filter.h"

#include <gtest/gtest.h>

#include <cmath>

namespace penumbra {
namespace {

Filter filter(const std::string& type, std::vector<std::pair<std::string, double>> numbers = {}) {
  SceneDescription d;
  d.files = {"filter.pbrt"};
  d.filter.type = type;
  for (const auto& [name, value] : numbers) {
    Param p;
    p.type = "float";
    p.name = name;
    p.numbers = {value};
    d.filter.params.all.push_back(p);
  }
  std::vector<std::string> warnings;
  auto f = Filter::build(d, warnings);
  EXPECT_TRUE(f.ok()) << f.status();
  return *f;
}

/// ∫ f(x) x² dx / ∫ f(x) dx along x, by the samples and their weights.
double second_moment(const Filter& f) {
  constexpr int kN = 200000;
  double sum = 0, weights = 0;
  for (int i = 0; i < kN; ++i) {
    const FilterSample s = f.sample({(i + 0.5) / kN, std::fmod(i * 0.6180339887, 1.0)});
    sum += s.weight * s.offset.x * s.offset.x;
    weights += s.weight;
  }
  EXPECT_NEAR(weights / kN, 1, 2e-3) << "a constant image must stay itself";
  return sum / weights;
}

TEST(Filter, PlacesAreTheInverseOfOffsets) {
  for (const char* type : {"box", "triangle", "gaussian", "mitchell"}) {
    const Filter f = filter(type);
    for (const int axis : {0, 1})
      for (int i = 0; i <= 200; ++i) {
        const double u = i / 200.0;
        double weight = 1;
        EXPECT_NEAR(f.place_of(axis, f.sample_along(axis, u, weight)), u, 1e-9) << type;
      }
    EXPECT_EQ(f.place_of(0, -f.radius().x), 0);
    EXPECT_EQ(f.place_of(0, f.radius().x), 1);
  }
}

TEST(Filter, MomentsOfTheKnownFilters) {
  EXPECT_NEAR(second_moment(filter("box", {{"xwidth", 1.0}, {"ywidth", 1.0}})), 1.0 / 3, 1e-3);
  // Triangle of radius r: r²/6.
  EXPECT_NEAR(second_moment(filter("triangle", {{"xwidth", 2.0}, {"ywidth", 2.0}})), 4.0 / 6, 2e-3);
  // Mitchell and Netravali, B = C = 1/3, radius 2: B/3.
  EXPECT_NEAR(second_moment(filter("mitchell")), 1.0 / 9, 4e-3);
  // Gaussian, α = 2, radius 2, shifted to reach zero: near its variance 1/(2α).
  EXPECT_NEAR(second_moment(filter("gaussian")), 0.25, 0.01);
}

TEST(Filter, StaysWithinItsRadius) {
  const Filter f = filter("mitchell", {{"xwidth", 1.5}, {"ywidth", 3.0}});
  for (int i = 0; i <= 1000; ++i) {
    const double u = std::min(i / 1000.0, 1 - 0x1p-53);
    const FilterSample s = f.sample({u, u});
    EXPECT_LE(std::abs(s.offset.x), 1.5);
    EXPECT_LE(std::abs(s.offset.y), 3.0);
    EXPECT_TRUE(std::isfinite(s.weight));
  }
}

TEST(Filter, RefusesARadiusThatIsNotPositive) {
  SceneDescription d;
  d.files = {"filter.pbrt"};
  d.filter.type = "box";
  Param p;
  p.type = "float";
  p.name = "xwidth";
  p.numbers = {0};
  d.filter.params.all = {p};
  std::vector<std::string> warnings;
  EXPECT_EQ(Filter::build(d, warnings).status().code(), absl::StatusCode::kInvalidArgument);
}

}  // namespace
}  // namespace penumbra
