#pragma once
// Lines on a light infinitely far away: quarters of great circles from a pole to its equator, each as the
// chord between its ends (design §8, after Nowrouzezahrai et al. 2014). With s on the chord, the direction is
// the chord's point minus x, and tan α = s/(1 − s) for the angle α from the pole.
#include <vector>

#include "scenes/math.h"

namespace penumbra {

/// Non-negative values on a grid of columns (azimuth) × rows (angle from the first pole), constant per cell,
/// for drawing meridians and points on them. Cells of a row have equal solid angles.
class ArcTable {
 public:
  /// Row-major; at least one cell, some value > 0.
  ArcTable(int width, int height, const std::vector<double>& values);

  /// Half a meridian: it starts at the first pole, or (`lower`) at the second.
  struct Meridian {
    int column = 0;
    bool lower = false;
    double phi = 0;  ///< azimuth, [0,2π)
  };
  /// A meridian with density (per azimuth) the integral of the values over it / total(); u in [0,1).
  Meridian choose(double u) const;
  /// The one through a unit direction, in the table's own axes.
  Meridian through(const Vec3d& w) const;

  /// Integral of all values over the sphere.
  double total() const { return total_; }
  /// The cell's row at s of a meridian, counted from the first pole.
  int row_at(const Meridian& m, double s) const;
  double value_at(const Meridian& m, double s) const { return value(m.column, row_at(m, s)); }
  /// ∫ value sin α dα over [lo,hi] of a meridian's s, to 2^-53 of the whole meridian's.
  double measure(const Meridian& m, double lo, double hi) const;
  /// s at fraction v of that measure.
  double sample(const Meridian& m, double lo, double hi, double v) const;

 private:
  double value(int column, int row) const { return values_[size_t(row) * size_t(width_) + size_t(column)]; }
  /// Row number k and its value, counted from the meridian's own pole.
  double value_from_pole(const Meridian& m, int k) const {
    return value(m.column, m.lower ? height_ - 1 - k : k);
  }
  int row_from_pole(double s) const;
  /// ∫ over whole rows [0,k) from the meridian's own pole.
  double rows_before(const Meridian& m, int k) const;
  /// s where row k from the meridian's own pole begins.
  double edge(int k) const;
  double half_measure(int column, bool lower) const;

  int width_, height_;
  std::vector<double> values_;
  std::vector<double>
      down_;  ///< per column height_ + 1 running sums over its rows of value × (cos top − cos bottom)
  std::vector<double> halves_;  ///< running sums over (column, upper), (column, lower)
  double total_ = 0;
};

/// cos α, sin α at s.
Vec2d arc_direction(double s);
/// cos α(lo) − cos α(hi), and sin²α(hi) − sin²α(lo), for lo <= hi: nothing cancels.
double cosine_difference(double lo, double hi);
double squared_sine_difference(double lo, double hi);

/// How points are spread on such a quarter: by the values of a table, or (null) by the cosine to the pole.
struct ArcMeasure {
  const ArcTable* table = nullptr;
  ArcTable::Meridian meridian;
  double total = 1;  ///< measure of the whole quarter
};
double relative_measure_of(const ArcMeasure& m, double lo, double hi);
double sample_within_measure(const ArcMeasure& m, double lo, double hi, double v);
/// What the density per solid angle at s is in proportion to.
double arc_value(const ArcMeasure& m, double s);

}  // namespace penumbra
