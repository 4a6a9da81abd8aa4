#include "worker/effects/density.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "proto/status.h"

namespace penumbra {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace

/// The eight samples about a cell of the lattice, and the density between them. Along a ray it is a cubic.
struct DensityGrid::Cell {
  double corner[2][2][2];  ///< [z][y][x]
  int origin[3];

  double at(const Vec3d& q) const {
    const double x = q.x - origin[0], y = q.y - origin[1], z = q.z - origin[2];
    double plane[2];
    for (int k = 0; k < 2; ++k) {
      const double low = corner[k][0][0] + x * (corner[k][0][1] - corner[k][0][0]);
      const double high = corner[k][1][0] + x * (corner[k][1][1] - corner[k][1][0]);
      plane[k] = low + y * (high - low);
    }
    // A hair outside the cell, by rounding, the blend of zeros may be a hair below 0.
    return std::max(0.0, plane[0] + z * (plane[1] - plane[0]));
  }

  /// ∫ of the density over [a,b]: Gauss's rule of two points is exact for a cubic.
  double column(const Vec3d& o, const Vec3d& d, double a, double b) const {
    const double middle = 0.5 * (a + b), half = 0.5 * (b - a), off = half / std::sqrt(3.0);
    return half * (at(o + d * (middle - off)) + at(o + d * (middle + off)));
  }

  /// Where in [a,b] the column from a reaches `target`: Newton's method, kept inside a shrinking bracket.
  double distance(const Vec3d& o, const Vec3d& d, double a, double b, double target) const {
    double lo = a, hi = b, t = 0.5 * (a + b);
    constexpr int kMostSteps = 128;  // bisection alone needs no more than a double has digits
    for (int i = 0; i < kMostSteps && lo < hi; ++i) {
      const double excess = column(o, d, a, t) - target;
      (excess > 0 ? hi : lo) = t;
      const double slope = at(o + d * t);
      double next = slope > 0 ? t - excess / slope : 0.5 * (lo + hi);
      if (!(next > lo && next < hi)) next = 0.5 * (lo + hi);
      if (next == t || !(next > lo && next < hi)) break;
      t = next;
    }
    return t;
  }
};

/// The cells that a ray passes, in order.
class DensityGrid::Walk {
 public:
  Walk(const DensityGrid& grid, const MediumRay& ray) : grid_(grid), t_(ray.t0), end_(ray.t1) {
    grid.to_lattice_.multVecMatrix(ray.o, o_);
    grid.to_lattice_.multDirMatrix(ray.d, d_);
    for (int i = 0; i < 3; ++i) clip(i);
    if (!(t_ < end_)) return;
    const Vec3d q = o_ + d_ * t_;
    for (int i = 0; i < 3; ++i) cell_[i] = std::clamp(int(std::floor(q[i])), -1, grid.n_[i] - 1);
  }

  /// The next cell with the part [a,b] of the ray in it; false: the ray has left.
  bool next(double& a, double& b) {
    if (!(t_ < end_)) return false;
    while (true) {
      int axis = -1;
      double exit = end_;
      for (int i = 0; i < 3; ++i) {
        if (d_[i] == 0) continue;
        const double plane = (cell_[i] + (d_[i] > 0 ? 1 : 0) - o_[i]) / d_[i];
        if (plane < exit) exit = plane, axis = i;
      }
      a = t_;
      b = std::max(a, exit);
      current_ = grid_.cell(cell_);
      t_ = b;
      if (axis < 0) {
        t_ = end_;
      } else {
        cell_[axis] += d_[axis] > 0 ? 1 : -1;
        if (cell_[axis] < -1 || cell_[axis] >= grid_.n_[axis]) t_ = end_;
      }
      if (a < b) return true;
      if (!(t_ < end_)) return false;
    }
  }
  double column(double a, double b) const { return current_.column(o_, d_, a, b); }
  double distance(double a, double b, double target) const { return current_.distance(o_, d_, a, b, target); }

 private:
  /// To the box: in the lattice it runs from half a cell before the first sample to half a cell past the
  /// last.
  void clip(int i) {
    const double lo = -0.5, hi = grid_.n_[i] - 0.5;
    if (d_[i] == 0) {
      if (!(o_[i] >= lo && o_[i] <= hi)) end_ = -kInfinity;
      return;
    }
    const double a = (lo - o_[i]) / d_[i], b = (hi - o_[i]) / d_[i];
    t_ = std::max(t_, std::min(a, b));
    end_ = std::min(end_, std::max(a, b));
  }

  const DensityGrid& grid_;
  Vec3d o_, d_;
  double t_, end_;
  int cell_[3] = {0, 0, 0};
  Cell current_{};
};

DensityGrid::DensityGrid(int nx, int ny, int nz, std::vector<float> values, const Matrix& to_unit)
    : n_{nx, ny, nz}, values_(std::move(values)) {
  PENUMBRA_CHECK(nx > 0 && ny > 0 && nz > 0 && values_.size() == size_t(nx) * size_t(ny) * size_t(nz));
  Matrix scale, shift;
  scale.setScale(Vec3d(nx, ny, nz));
  shift.setTranslation(Vec3d(-0.5));
  to_lattice_ = to_unit * scale * shift;
}

float DensityGrid::value(int x, int y, int z) const {
  if (x < 0 || y < 0 || z < 0 || x >= n_[0] || y >= n_[1] || z >= n_[2]) return 0;
  return values_[(size_t(z) * size_t(n_[1]) + size_t(y)) * size_t(n_[0]) + size_t(x)];
}

DensityGrid::Cell DensityGrid::cell(const int index[3]) const {
  Cell c;
  for (int i = 0; i < 3; ++i) c.origin[i] = index[i];
  for (int z = 0; z < 2; ++z)
    for (int y = 0; y < 2; ++y)
      for (int x = 0; x < 2; ++x) c.corner[z][y][x] = value(index[0] + x, index[1] + y, index[2] + z);
  return c;
}

double DensityGrid::at(const Vec3d& p) const {
  Vec3d q;
  to_lattice_.multVecMatrix(p, q);
  int index[3];
  for (int i = 0; i < 3; ++i) {
    if (!(q[i] >= -0.5 && q[i] <= n_[i] - 0.5)) return 0;
    index[i] = int(std::floor(q[i]));
  }
  return cell(index).at(q);
}

double DensityGrid::column(const MediumRay& ray) const {
  Walk walk(*this, ray);
  double sum = 0;
  for (double a = 0, b = 0; walk.next(a, b);) sum += walk.column(a, b);
  return sum;
}

double DensityGrid::distance(const MediumRay& ray, double column) const {
  Walk walk(*this, ray);
  double last = ray.t0;
  for (double a = 0, b = 0; walk.next(a, b);) {
    const double here = walk.column(a, b);
    if (here > 0) last = b;
    if (column < here) return walk.distance(a, b, column);
    column -= here;
  }
  return last;  // by rounding: the whole column is reached where the last of it ends
}

namespace {

struct At {
  const Vec3d& p;
  double operator()(const UniformDensity&) const { return 1; }
  double operator()(const DensityGrid& grid) const { return grid.at(p); }
};
struct Column {
  const MediumRay& ray;
  double operator()(const UniformDensity&) const { return ray.t1 - ray.t0; }
  double operator()(const DensityGrid& grid) const { return grid.column(ray); }
};
struct Distance {
  const MediumRay& ray;
  double column;
  double operator()(const UniformDensity&) const { return std::min(ray.t0 + column, ray.t1); }
  double operator()(const DensityGrid& grid) const { return grid.distance(ray, column); }
};

}  // namespace

double density_at(const Density& density, const Vec3d& p) {
  return std::visit(At{p}, density);
}
double column(const Density& density, const MediumRay& ray) {
  return std::visit(Column{ray}, density);
}
double distance_at(const Density& density, const MediumRay& ray, double column) {
  return std::visit(Distance{ray, column}, density);
}

}  // namespace penumbra
