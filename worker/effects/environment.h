#pragma once
// Light from infinitely far away: a constant or a map over directions, sampled by its luminance.
// Wanted only where the scene has an `infinite` light (design §8).
#include <memory>
#include <optional>
#include <vector>

#include "absl/status/statusor.h"
#include "scenes/description.h"
#include "scenes/files.h"
#include "scenes/math.h"
#include "worker/lights/arc.h"

namespace penumbra {

struct EnvironmentSample {
  Vec3f wi;  ///< unit, world space
  Rgb radiance;
  double pdf = 0;  ///< sr⁻¹
};

class Environment {
 public:
  /// From `LightSource "infinite"`: L/scale, mapname (v3, equirectangular) or filename (v4: equal-area
  /// where the map is square, else equirectangular). A missing map is a warning and the constant alone.
  static absl::StatusOr<Environment> build(const LightEntity& light, const SceneDescription& description,
                                           const SceneFiles& files, bool strict,
                                           std::vector<std::string>& warnings);

  Rgb radiance(const Vec3f& direction) const;
  /// A direction with density proportional to the luminance of its texel (uniform for a constant).
  EnvironmentSample sample(const Vec2d& u) const;
  /// Density of sample() at a direction, sr⁻¹.
  double pdf(const Vec3f& direction) const;
  /// Luminance over the meridians of the map's poles, for lines; made when first asked for, by any number of
  /// threads (16 bytes a texel). Of an equirectangular map it is that of the texels, of an equal-area map a
  /// coarser likeness that is 0 nowhere, of a constant 1.
  const ArcTable& arcs() const;
  /// Of a cell of arcs() that the direction lies in to rounding: its texel's, if it is one.
  Rgb radiance(int column, int row, const Vec3f& direction) const;
  /// Unit directions between the world and the axes of arcs().
  Vec3d to_world(const Vec3d& local) const { return (local * Imath::M33d(to_world_)).normalized(); }
  Vec3d to_local(const Vec3d& world) const { return (world * Imath::M33d(to_light_)).normalized(); }
  /// Mean radiance over the sphere, for choosing among lights.
  double mean_luminance() const;

 private:
  struct Map;
  static ArcTable likeness(const Map& map);
  Rgb scale_{1};
  Imath::M33f to_light_, to_world_;
  std::shared_ptr<const Map> map_;  ///< empty: constant
};

}  // namespace penumbra
