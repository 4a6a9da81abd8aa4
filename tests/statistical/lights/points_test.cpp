// Point strategies: where the samples fall (χ² against exact cell probabilities), and that the density they
// report is the inverse of the map's Jacobian.
#include <numbers>

#include "tests/statistical/lights/cases.h"
#include "tests/statistical/lights/statistics.h"
#include "worker/sampling/warp.h"

namespace penumbra::statistical {
namespace {

constexpr int kSamples = 40000;
constexpr int kCells = 8;  // along each axis
constexpr double kSigmas = 4.5;

/// Fractions of a quad's edges at p.
Vec2d quad_fractions(const QuadShape& quad, const Vec3d& p) {
  const Vec3d d = p - Vec3d(quad.o), u(quad.u), v(quad.v), n = u.cross(v);
  return {d.cross(v).dot(n) / n.length2(), u.cross(d).dot(n) / n.length2()};
}

/// Solid angle of a triangle in long double, Van Oosterom & Strackee without any of the product's care.
double solid_angle(const Vec3d& x, const Vec3d& p0, const Vec3d& p1, const Vec3d& p2) {
  using V = Imath::Vec3<long double>;
  const V a = V(p0) - V(x), b = V(p1) - V(x), c = V(p2) - V(x);
  const auto length = [](const V& v) { return std::sqrt(v.dot(v)); };
  const long double la = length(a), lb = length(b), lc = length(c);
  const long double determinant = a.dot((b - a).cross(c - a));
  return static_cast<double>(
      2 * std::atan2(std::abs(determinant), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb));
}

int cell_of(double fraction) {
  return std::min(std::max(static_cast<int>(fraction * kCells), 0), kCells - 1);
}

/// Corner of the (i,j) cell of a quad.
Vec3d quad_point(const QuadShape& q, double s, double t) {
  return Vec3d(q.o) + s * Vec3d(q.u) + t * Vec3d(q.v);
}

/// Solid angle of each cell of a quad's grid, relative to their sum.
std::vector<double> quad_cell_probabilities(const QuadShape& q, const Vec3d& x) {
  std::vector<double> cells;
  double sum = 0;
  for (int i = 0; i < kCells; ++i)
    for (int j = 0; j < kCells; ++j) {
      const auto at = [&](int di, int dj) {
        return quad_point(q, static_cast<double>(i + di) / kCells, static_cast<double>(j + dj) / kCells);
      };
      cells.push_back(solid_angle(x, at(0, 0), at(1, 0), at(1, 1)) +
                      solid_angle(x, at(0, 0), at(1, 1), at(0, 1)));
      sum += cells.back();
    }
  for (double& c : cells) c /= sum;
  return cells;
}

TEST(SolidAngleSampling, QuadsAreCoveredInProportion) {
  for (const Case& c : concatenated({rectangle_cases(), parallelogram_cases()})) {
    const auto& quad = std::get<QuadShape>(c.shape);
    const SeenShape seen(c.shape, c.x);
    ASSERT_GT(seen.solid_angle(), 0) << c.name;
    std::vector<int> hits(kCells * kCells);
    for (int i = 0; i < kSamples; ++i) {
      const Vec2d f = quad_fractions(quad, seen.sample(random_square(1, i)).p);
      ++hits[cell_of(f.x) * kCells + cell_of(f.y)];
    }
    EXPECT_LT(chi_square_sigmas(hits, quad_cell_probabilities(quad, c.x)), kSigmas) << c.name;
  }
}

TEST(SolidAngleSampling, TrianglesAreCoveredInProportion) {
  // A triangle cut into kCells² similar ones: strips by the weight of p2, upright and inverted in each.
  for (const Case& c : triangle_cases()) {
    const auto& t = std::get<TriangleShape>(c.shape);
    const Vec3d p0(t.p0), u = Vec3d(t.p1) - p0, v = Vec3d(t.p2) - p0, n = u.cross(v);
    const auto at = [&](int i, int j) {
      return p0 + (static_cast<double>(i) / kCells) * u + (static_cast<double>(j) / kCells) * v;
    };
    std::vector<double> probability(2 * kCells * kCells);
    double sum = 0;
    for (int i = 0; i < kCells; ++i)
      for (int j = 0; i + j < kCells; ++j) {
        double* cell = &probability[2 * (i * kCells + j)];
        cell[0] = solid_angle(c.x, at(i, j), at(i + 1, j), at(i, j + 1));
        if (i + j + 1 < kCells) cell[1] = solid_angle(c.x, at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
        sum += cell[0] + cell[1];
      }
    for (double& p : probability) p /= sum;

    const SeenShape seen(c.shape, c.x);
    ASSERT_NEAR(seen.solid_angle() / sum, 1, 1e-9) << c.name;
    std::vector<int> hits(probability.size());
    for (int k = 0; k < kSamples; ++k) {
      const Vec3d d = seen.sample(random_square(2, k)).p - p0;
      const double a = d.cross(v).dot(n) / n.length2() * kCells, b = u.cross(d).dot(n) / n.length2() * kCells;
      const int i = std::min(std::max(static_cast<int>(a), 0), kCells - 1);
      const int j = std::min(std::max(static_cast<int>(b), 0), kCells - 1 - i);
      const bool inverted = i + j + 1 < kCells && (a - i) + (b - j) > 1;
      ++hits[2 * (i * kCells + j) + (inverted ? 1 : 0)];
    }
    EXPECT_LT(chi_square_sigmas(hits, probability), kSigmas) << c.name;
  }
}

TEST(SolidAngleSampling, SpheresAreCoveredInProportion) {
  // In the cone around the centre 1 − cosθ and the azimuth are uniform; from inside so are all directions.
  for (const Case& c : sphere_cases()) {
    const auto& sphere = std::get<SphereShape>(c.shape);
    const SeenShape seen(c.shape, c.x);
    const Vec3d to_center = Vec3d(sphere.center) - c.x;
    const Vec3d axis = sphere.inwards ? Vec3d(0, 0, 1) : to_center.normalized();
    Vec3d s, t;
    frame(axis, s, t);
    const double one_minus_cos_max = sphere.inwards ? 2 : seen.solid_angle() / (2 * std::numbers::pi);
    std::vector<int> hits(kCells * kCells);
    for (int i = 0; i < kSamples; ++i) {
      const LightPoint p = seen.sample(random_square(3, i));
      EXPECT_NEAR((p.p - Vec3d(sphere.center)).length(), sphere.radius, 1e-9);
      const Vec3d w = (p.p - c.x).normalized();
      // 1 − cosθ = |w − axis|²/2, which keeps its digits for far spheres.
      const double ring = 0.5 * (w - axis).length2() / one_minus_cos_max;
      const double turn = std::atan2(w.dot(t), w.dot(s)) / (2 * std::numbers::pi) + 0.5;
      ++hits[cell_of(ring) * kCells + cell_of(turn)];
    }
    const std::vector<double> even(kCells * kCells, 1.0 / (kCells * kCells));
    EXPECT_LT(chi_square_sigmas(hits, even), kSigmas) << c.name;
  }
}

TEST(AreaSampling, ShapesAreCoveredEvenly) {
  const std::vector<double> even(kCells * kCells, 1.0 / (kCells * kCells));
  const auto judge = [&](const Case& c, const auto& place) {
    std::vector<int> hits(kCells * kCells);
    for (int i = 0; i < kSamples; ++i) {
      const Vec2d f = place(sample_area(c.shape, c.x, random_square(4, i)).p);
      ++hits[cell_of(f.x) * kCells + cell_of(f.y)];
    }
    EXPECT_LT(chi_square_sigmas(hits, even), kSigmas) << c.name;
  };
  for (const Case& c : parallelogram_cases())
    judge(c, [&](const Vec3d& p) { return quad_fractions(std::get<QuadShape>(c.shape), p); });
  for (const Case& c : triangle_cases()) {
    const auto& t = std::get<TriangleShape>(c.shape);
    const QuadShape doubled{t.p0, t.p1 - t.p0, t.p2 - t.p0};
    // Weight b of p2 with density 2(1−b), and the place along the strip.
    if (c.name == "above")
      judge(c, [&](const Vec3d& p) {
        const Vec2d f = quad_fractions(doubled, p);
        return Vec2d(1 - (1 - f.y) * (1 - f.y), f.x / (1 - f.y));
      });
  }
  for (const Case& c : sphere_cases()) {
    const auto& sphere = std::get<SphereShape>(c.shape);
    judge(c, [&](const Vec3d& p) {
      const Vec3d n = (p - Vec3d(sphere.center)).normalized();
      return Vec2d(0.5 + 0.5 * n.z, std::atan2(n.y, n.x) / (2 * std::numbers::pi) + 0.5);
    });
  }
  for (const Case& c : area_cases()) {
    judge(c, [&](const Vec3d& p) {
      Vec3d s, t;
      if (const auto* disk = std::get_if<DiskShape>(&c.shape)) {
        frame(Vec3d(disk->n).normalized(), s, t);
        const Vec3d d = p - Vec3d(disk->center);
        const double inner = disk->inner, outer = disk->radius;
        return Vec2d((d.length2() - inner * inner) / (outer * outer - inner * inner),
                     std::atan2(d.dot(t), d.dot(s)) / (2 * std::numbers::pi) + 0.5);
      }
      const auto& tube = std::get<CylinderShape>(c.shape);
      const Vec3d axis(tube.axis), d = p - Vec3d(tube.base);
      frame(axis.normalized(), s, t);
      return Vec2d(d.dot(axis) / axis.length2(),
                   std::atan2(d.dot(t), d.dot(s)) / (2 * std::numbers::pi) + 0.5);
    });
  }
}

std::vector<Case> flat_and_sphere_cases() {
  return concatenated({rectangle_cases(), parallelogram_cases(), triangle_cases(), sphere_cases()});
}

/// Fraction of the random numbers where pdf × Jacobian is not 1 to the differences' accuracy. Folds of a map
/// (the diagonal of a triangle's square, a parallelogram's two halves) and peaks as narrow as the step make a
/// few differences meaningless.
template <class Sample>
double fraction_off(const Case& c, const Sample& sample, double tolerance) {
  constexpr int kTries = 400;
  int off = 0, judged = 0;
  for (int i = 0; i < kTries; ++i) {
    const Vec2d u = random_square(5, i) * 0.96 + Vec2d(0.02);
    const LightPoint point = sample(u);
    if (point.pdf == 0) continue;  // faces away
    ++judged;
    const double jacobian = direction_jacobian([&](const Vec2d& w) { return sample(w).p - c.x; }, u);
    if (!(std::abs(point.pdf * jacobian - 1) < tolerance)) ++off;
  }
  return static_cast<double>(off) / std::max(1, judged);
}

TEST(PointStrategies, DensityTimesJacobianIsOne) {
  for (const Case& c : flat_and_sphere_cases()) {
    const SeenShape seen(c.shape, c.x);
    EXPECT_LT(fraction_off(
                  c, [&](const Vec2d& u) { return seen.sample(u); }, 1e-3),
              0.01)
        << "sa, " << c.name;
  }
  for (const Case& c : concatenated({flat_and_sphere_cases(), area_cases()}))
    EXPECT_LT(fraction_off(
                  c, [&](const Vec2d& u) { return sample_area(c.shape, c.x, u); }, 1e-3),
              0.03)
        << "area, " << c.name;
}

TEST(PointStrategies, DensityOfASampleIsTheDensityAtItsPoint) {
  for (const Case& c : concatenated(
           {rectangle_cases(), parallelogram_cases(), triangle_cases(), sphere_cases(), area_cases()})) {
    const SeenShape seen(c.shape, c.x);
    for (int i = 0; i < 100; ++i) {
      const LightPoint s = seen.sample(random_square(6, i)),
                       a = sample_area(c.shape, c.x, random_square(7, i));
      EXPECT_EQ(seen.pdf(s.p, s.n), s.pdf) << c.name;
      EXPECT_EQ(pdf_area(c.shape, c.x, a.p, a.n), a.pdf) << c.name;
    }
  }
}

TEST(PointStrategies, DensitiesIntegrateToOne) {
  // ∫ pdf dω by points of both strategies, half and half: the ratio is at most 2, so that the mean's error
  // can be trusted whatever one strategy alone would miss.
  for (const Case& c : flat_and_sphere_cases()) {
    const SeenShape seen(c.shape, c.x);
    MeanTest area_mean, angle_mean;
    double facing = 0;  // the share of area samples that x sees
    for (int i = 0; i < kSamples; ++i) {
      const Vec2d u = random_square(8, i);
      const bool by_area = i % 2 == 0;
      const LightPoint p = by_area ? sample_area(c.shape, c.x, u) : seen.sample(u);
      if (by_area && p.pdf > 0) facing += 2.0 / kSamples;
      const double a = pdf_area(c.shape, c.x, p.p, p.n), s = seen.pdf(p.p, p.n), mixture = 0.5 * (a + s);
      area_mean.add(mixture > 0 ? a / mixture : 0);
      angle_mean.add(mixture > 0 ? s / mixture : 0);
    }
    EXPECT_LT(std::abs(angle_mean.mean() - 1), 5 * angle_mean.error() + 1e-9) << c.name;
    EXPECT_NEAR(area_mean.mean(), facing, 5 * area_mean.error() + 5 / std::sqrt(kSamples)) << c.name;
  }
}

}  // namespace
}  // namespace penumbra::statistical
