#pragma once
// How much of a medium there is along a ray: everywhere the same, or on a grid. A medium's coefficients are
// per unit of density; its optical depth is coefficient × column, where the column is the integral of the
// density. Exact to rounding in both kinds: no random numbers, so transmittance has no variance and needs no
// majorant.
#include <cstdint>
#include <memory>
#include <variant>
#include <vector>

#include "scenes/math.h"

namespace penumbra {

/// Points o + t d in the world, d unit, t in [t0,t1]; t1 may be infinite.
struct MediumRay {
  Vec3d o{0, 0, 0}, d{0, 0, 1};
  double t0 = 0, t1 = 0;
};

/// Density 1 everywhere.
struct UniformDensity {};

/// pbrt's grid: samples at the centres of nx × ny × nz cells of a box, trilinear between them, falling to 0
/// half a cell beyond the outermost centres; the box cuts that off. x runs fastest.
class DensityGrid {
 public:
  /// `to_unit`: world to the unit cube, affine. Values finite and not negative, nx·ny·nz of them.
  DensityGrid(int nx, int ny, int nz, std::vector<float> values, const Matrix& to_unit);

  double at(const Vec3d& p) const;
  double column(const MediumRay& ray) const;
  double distance(const MediumRay& ray, double column) const;

 private:
  struct Cell;
  class Walk;
  float value(int x, int y, int z) const;
  Cell cell(const int index[3]) const;

  int n_[3];
  std::vector<float> values_;
  Matrix to_lattice_;  ///< world to the lattice whose integer points are the samples
};

using Density = std::variant<UniformDensity, DensityGrid>;

double density_at(const Density& density, const Vec3d& p);
/// ∫ density dt over the ray's [t0,t1]; infinite where that is.
double column(const Density& density, const MediumRay& ray);
/// The t at which the column from t0 reaches `column`, within [t0,t1].
double distance_at(const Density& density, const MediumRay& ray, double column);

}  // namespace penumbra
