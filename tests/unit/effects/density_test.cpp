// A grid's density along rays, against sums over many short steps.
#include "worker/effects/density.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace penumbra {
namespace {

/// 3 × 2 × 4 samples in a box that is turned, stretched and moved.
struct Grid {
  Grid() {
    std::mt19937 generator(7);
    std::vector<float> values;
    for (int i = 0; i < 24; ++i) values.push_back(i % 5 == 0 ? 0 : float(generator() % 1000) / 250);
    Matrix scale, turn, move;
    scale.setScale(Vec3d(2, 0.5, 3));
    turn.setEulerAngles(Vec3d(0.3, -0.7, 1.1));
    move.setTranslation(Vec3d(10, -4, 2));
    to_world = scale * turn * move;
    density = DensityGrid(3, 2, 4, std::move(values), to_world.gjInverse());
  }
  Vec3d world(const Vec3d& unit) const {
    Vec3d out;
    to_world.multVecMatrix(unit, out);
    return out;
  }
  MediumRay between(const Vec3d& from, const Vec3d& to, double past = 0) const {
    const Vec3d a = world(from), b = world(to);
    return {a, (b - a).normalized(), 0, (b - a).length() + past};
  }
  Matrix to_world;
  Density density;
};

double by_steps(const Density& density, const MediumRay& ray) {
  constexpr int kSteps = 200000;
  double sum = 0;
  const double step = (ray.t1 - ray.t0) / kSteps;
  for (int i = 0; i < kSteps; ++i) sum += density_at(density, ray.o + ray.d * (ray.t0 + (i + 0.5) * step));
  return sum * step;
}

TEST(DensityGrid, IsPbrtsTrilinearTable) {
  const Density density = DensityGrid(2, 1, 1, {2, 6}, Matrix());
  EXPECT_NEAR(density_at(density, Vec3d(0.25, 0.5, 0.5)), 2, 1e-15);
  EXPECT_NEAR(density_at(density, Vec3d(0.5, 0.5, 0.5)), 4, 1e-15);
  EXPECT_NEAR(density_at(density, Vec3d(1, 0.5, 0.5)), 3, 1e-15);  // half way to the zeros beyond
  EXPECT_EQ(density_at(density, Vec3d(1.001, 0.5, 0.5)), 0);
  EXPECT_EQ(density_at(density, Vec3d(0.5, -0.001, 0.5)), 0);
}

TEST(DensityGrid, ColumnIsTheSumOfSteps) {
  const Grid grid;
  const MediumRay rays[] = {grid.between({-0.2, 0.1, 0.3}, {1.3, 0.9, 0.8}),
                            grid.between({0.5, 0.5, -1}, {0.5, 0.5, 2}),
                            grid.between({0.5, 0.5, 0.5}, {0.51, 0.5, 0.5}),
                            grid.between({0.3, 0.4, 0.2}, {0.9, 0.1, 0.7}, -0.1),
                            grid.between({1.4, 0.2, 0.9}, {-0.4, 0.8, 0.1}),
                            grid.between({1. / 6, 0.25, 0.125}, {5. / 6, 0.75, 0.875})};
  for (const MediumRay& ray : rays) {
    const double sum = by_steps(grid.density, ray);
    EXPECT_GT(sum, 0);
    EXPECT_NEAR(column(grid.density, ray), sum, 2e-5 * sum);
  }
  EXPECT_EQ(column(grid.density, grid.between({-1, -1, -1}, {-1, 2, -1})), 0);
}

TEST(DensityGrid, DistanceInvertsTheColumn) {
  const Grid grid;
  const MediumRay ray = grid.between({-0.2, 0.1, 0.3}, {1.3, 0.9, 0.8});
  const double whole = column(grid.density, ray);
  for (const double share : {0.0, 1e-9, 0.01, 0.3, 0.77, 0.999999}) {
    MediumRay part = ray;
    part.t1 = distance_at(grid.density, ray, share * whole);
    EXPECT_NEAR(column(grid.density, part), share * whole, 1e-13 * whole) << share;
  }
  EXPECT_LE(distance_at(grid.density, ray, whole), ray.t1);
}

TEST(DensityGrid, RaysWithoutEnd) {
  const Density density = DensityGrid(2, 2, 2, std::vector<float>(8, 1.5f), Matrix());
  MediumRay ray{Vec3d(0.5, 0.5, -3), Vec3d(0, 0, 1), 0, std::numeric_limits<double>::infinity()};
  // 1/4 and 3/4 are centres: 1.5 between them, falling to half of it at the faces.
  EXPECT_NEAR(column(density, ray), 1.5 * 0.5 + 2 * 0.25 * 0.75 * 1.5, 1e-14);
}

}  // namespace
}  // namespace penumbra
