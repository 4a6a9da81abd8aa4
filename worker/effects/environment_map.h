#pragma once
// The picture behind light from infinitely far away: texels of constant radiance over the sphere, and the
// tables that directions are drawn from.
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "scenes/math.h"
#include "worker/lights/arc.h"
#include "worker/lights/window_table.h"

namespace penumbra {

class EnvironmentMap {
 public:
  /// Reads a map as linear RGB; grey maps are spread over the channels. `square_is_equal_area`: pbrt-v4's
  /// rule, else every map is equirectangular.
  absl::Status read(const std::string& path, bool square_is_equal_area);

  bool equal_area() const { return equal_area_; }
  const Rgb& texel(int x, int y) const { return texels_[size_t(y) * size_t(width_) + size_t(x)]; }
  /// ∫ luminance dω over the sphere.
  double total() const { return rows_.back(); }
  /// The texel of a unit direction in the map's own axes.
  void texel_of(const Vec3d& w, int& x, int& y) const;
  /// The direction of a place in the map, in texels from its corner.
  Vec3d direction_at(double x, double y) const;
  double luminance_at(const Vec3d& w) const;
  /// A direction with density luminance / total() per solid angle, and its texel.
  Vec3d sample(const Vec2d& u, int& x, int& y) const;

  /// Luminance over the meridians of the map's poles. Of an equirectangular map it is that of the texels, of
  /// an equal-area map a coarser likeness that is 0 nowhere.
  ArcTable meridians() const;
  /// A likeness, 0 nowhere, of the luminance that is seen through a window: WindowTable's square is that of
  /// the angles to axis 2 in the planes of axes 0 and 2, 1 and 2 (portal.h), its values are luminance per
  /// solid angle × solid angle per cell. `to_local`: from the window's axes, as rows, to the map's.
  WindowTable seen_through(const Imath::M33d& to_local) const;

 private:
  void tabulate();
  /// Solid angle of any texel of row y.
  double texel_solid_angle(int y) const;
  /// What a cell has at least: where no subsample fell light may still be.
  double least() const;
  const double* row(int y) const { return columns_.data() + size_t(y) * (size_t(width_) + 1); }

  int width_ = 0, height_ = 0;
  bool equal_area_ = false;
  std::vector<Rgb> texels_;
  /// Running sums of luminance × texel solid angle: per row over its columns, and over the rows.
  std::vector<double> columns_, rows_;
};

double luminance_of(const Rgb& c);

}  // namespace penumbra
