// Points drawn within windows of a table: where they fall, and how their density goes with it.
#include "worker/lights/window_table.h"

#include <numbers>

#include "tests/statistical/lights/statistics.h"

namespace penumbra::statistical {
namespace {

constexpr int kSamples = 40000, kCells = 8;
constexpr double kSigmas = 4.5;

WindowTable table(int width, int height) {
  std::vector<double> values;
  for (int i = 0; i < width * height; ++i) values.push_back(0.1 + random_square(7, uint64_t(i)).x);
  values[size_t(width * height / 3)] = 50;
  return WindowTable(width, height, values);
}

const std::vector<WindowTable::Window> kWindows = {
    {{0, 0}, {1, 1}},           {{0.13, 0.2}, {0.81, 0.77}},    {{0.31, 0.31}, {0.32, 0.9}},
    {{0.5, 0.25}, {0.75, 0.5}}, {{0.4, 0.6}, {0.4001, 0.6002}}, {{0, 0.9}, {1e-3, 1}}};

Vec2d at(const WindowTable::Window& w, double s, double t) {
  return {w.lo.x + s * (w.hi.x - w.lo.x), w.lo.y + t * (w.hi.y - w.lo.y)};
}

TEST(WindowTable, PointsFallInProportionToTheValues) {
  const WindowTable t = table(13, 9);
  for (const WindowTable::Window& w : kWindows) {
    const double whole = t.integral(w);
    std::vector<double> probability;
    for (int j = 0; j < kCells; ++j)
      for (int i = 0; i < kCells; ++i)
        probability.push_back(t.integral({at(w, double(i) / kCells, double(j) / kCells),
                                          at(w, double(i + 1) / kCells, double(j + 1) / kCells)}) /
                              whole);
    std::vector<int> hits(probability.size(), 0);
    for (int n = 0; n < kSamples; ++n) {
      const Vec2d p = t.sample(w, whole, random_square(1, uint64_t(n)));
      const auto cell = [](double v, double lo, double hi) {
        return std::clamp(int((v - lo) / (hi - lo) * kCells), 0, kCells - 1);
      };
      ASSERT_TRUE(p.x >= w.lo.x && p.x <= w.hi.x && p.y >= w.lo.y && p.y <= w.hi.y);
      ++hits[size_t(cell(p.y, w.lo.y, w.hi.y) * kCells + cell(p.x, w.lo.x, w.hi.x))];
    }
    EXPECT_LT(chi_square_sigmas(hits, probability), kSigmas) << w.lo << w.hi;
  }
}

/// The inverse of the density has the window's area as its mean.
TEST(WindowTable, TheDensityIsThatOfTheSamples) {
  const WindowTable t = table(64, 32);
  for (const WindowTable::Window& w : kWindows) {
    const double whole = t.integral(w), area = (w.hi.x - w.lo.x) * (w.hi.y - w.lo.y);
    MeanTest mean;
    for (int n = 0; n < kSamples; ++n)
      mean.add(1 / t.pdf(whole, t.sample(w, whole, random_square(2, uint64_t(n)))) / area);
    if (mean.error() > 1e-9)
      EXPECT_LT(std::abs(mean.sigmas(1)), kSigmas) << w.lo << w.hi;
    else
      EXPECT_NEAR(mean.mean(), 1, 1e-9);
  }
}

TEST(WindowTable, IntegralsAddUp) {
  const WindowTable t = table(40, 24);
  const WindowTable::Window w{{0.21, 0.05}, {0.93, 0.55}};
  double sum = 0;
  for (int i = 0; i < 97; ++i)
    sum += t.integral({{0.21 + 0.72 * i / 97, 0.05}, {0.21 + 0.72 * (i + 1) / 97, 0.55}});
  EXPECT_NEAR(sum, t.integral(w), 1e-11 * sum);
}

/// window_solid_angle() is dω per area of places.
TEST(WindowPlaces, TheSolidAngleIsTheJacobian) {
  for (int n = 0; n < 50; ++n) {
    const Vec2d u = random_square(3, uint64_t(n)), place(0.02 + 0.96 * u.x, 0.02 + 0.96 * u.y);
    const Vec3d d = window_direction(place);
    EXPECT_NEAR(window_place(d * 3.5).x, place.x, 1e-13);
    EXPECT_NEAR(window_place(d * 3.5).y, place.y, 1e-13);
    const double jacobian =
        direction_jacobian([](const Vec2d& p) { return window_direction(p); }, place, 1e-4);
    EXPECT_NEAR(window_solid_angle(d * 3.5) / jacobian, 1, 1e-5) << place;
  }
}

}  // namespace
}  // namespace penumbra::statistical
