#pragma once
// What is seen through a window of a picture at infinity: in the angles α = atan(x/z), β = atan(y/z) about
// axes along the window's edges, it is an axis-parallel rectangle from wherever one looks (Bitterli, Novák &
// Jarosz 2015, «Portal-masked environment map sampling»). Points within such rectangles are drawn from a
// summed-area table.
#include <vector>

#include "scenes/math.h"

namespace penumbra {

/// Place (α, β) / π + 1/2 of a direction (x, y, z), z > 0, of any length; in [0,1]².
Vec2d window_place(const Vec3d& direction);
/// The direction (x, y, 1) at a place within (0,1)².
Vec3d window_direction(const Vec2d& place);
/// Solid angle per area of places at a direction, z > 0.
double window_solid_angle(const Vec3d& direction);

/// Positive values over the unit square, constant in each cell of a grid.
class WindowTable {
 public:
  struct Window {
    Vec2d lo, hi;  ///< lo < hi, within [0,1]²
  };
  /// Row-major, each > 0.
  WindowTable(int width, int height, const std::vector<double>& values);

  /// ∫ of the values over a window, over that of a cell of value 1. Relative to itself right to
  /// 2^-52 (sum of all values) / (sum of those that it touches).
  double integral(const Window& window) const;
  /// A place in the window, and the density of sample() there, per area of the unit square.
  Vec2d sample(const Window& window, double integral, const Vec2d& u) const;
  double pdf(double integral, const Vec2d& place) const;

 private:
  double value(int x, int y) const { return values_[size_t(y) * size_t(width_) + size_t(x)]; }
  /// Sum over cells [x0,x1) × [y0,y1).
  double block(int x0, int x1, int y0, int y1) const;
  int cell(int axis, double place) const;
  double cells(int axis) const { return axis == 0 ? width_ : height_; }
  /// Along an axis: within `window`, the place at which its part before reaches a fraction u of its integral.
  double place_along(int axis, const Window& window, double integral, double u) const;

  int width_, height_;
  std::vector<double> values_, sums_;  ///< sums_: (width + 1) × (height + 1), over all cells before
};

}  // namespace penumbra
