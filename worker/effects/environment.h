#pragma once
// Light from infinitely far away: a constant or a map over directions, sampled by its luminance, all around
// or through a portal alone. Wanted only where the scene has an `infinite` light (design §8).
#include <memory>
#include <optional>
#include <vector>

#include "absl/status/statusor.h"
#include "scenes/description.h"
#include "scenes/files.h"
#include "scenes/math.h"
#include "worker/effects/portal.h"
#include "worker/lights/arc.h"

namespace penumbra {

class EnvironmentMap;

struct EnvironmentSample {
  Vec3f wi;  ///< unit, world space
  Rgb radiance;
  double pdf = 0;  ///< sr⁻¹
};

class Environment {
 public:
  /// From `LightSource "infinite"`: L/scale, mapname (v3, equirectangular) or filename (v4: equal-area
  /// where the map is square, else equirectangular), portal (v4; here with a constant, too). A missing map is
  /// a warning and the constant alone. InvalidArgument: an unreadable map, a portal that is no rectangle.
  static absl::StatusOr<Environment> build(const LightEntity& light, const SceneDescription& description,
                                           const SceneFiles& files, bool strict,
                                           std::vector<std::string>& warnings);

  /// What arrives at x from a direction (unit) if nothing hides it: 0 where there is a portal and the
  /// direction is not through it.
  Rgb radiance(const Vec3d& x, const Vec3f& direction) const;
  /// The same of directions that are known to be through the portal.
  Rgb radiance(const Vec3f& direction) const;
  /// A direction with density proportional to the luminance of its texel (uniform for a constant), portal or
  /// not; SeenPortal has its own.
  EnvironmentSample sample(const Vec2d& u) const;
  /// Density of sample() at a direction, sr⁻¹.
  double pdf(const Vec3f& direction) const;
  /// Null: light comes from everywhere.
  const Portal* portal() const { return portal_.get(); }
  /// Luminance over the meridians of the map's poles, for lines; made when first asked for, by any number of
  /// threads (16 bytes a texel). Of an equirectangular map it is that of the texels, of an equal-area map a
  /// coarser likeness that is 0 nowhere, of a constant 1.
  const ArcTable& arcs() const;
  /// Of a cell of arcs() that the direction lies in to rounding: its texel's, if it is one.
  Rgb radiance(int column, int row, const Vec3f& direction) const;
  /// Do meridians of the map's poles have the measure of arcs() in the world? Not under a transform that
  /// changes angles.
  bool has_arcs() const { return volume_ == 0; }
  /// Unit directions between the world and the axes of arcs().
  Vec3d to_world(const Vec3d& local) const { return (local * Imath::M33d(to_world_)).normalized(); }
  Vec3d to_local(const Vec3d& world) const { return (world * Imath::M33d(to_light_)).normalized(); }
  /// Mean radiance over the sphere, as if there were no portal.
  double mean_luminance() const;
  /// An estimate of what arrives at x, for choosing among lights; W m⁻² of luminance, 0 only where nothing
  /// does.
  double irradiance(const Vec3d& x) const;

 private:
  struct Arcs;
  void use(std::shared_ptr<const EnvironmentMap> map);
  /// Density in the world over that in the map's axes, of a unit direction whose image has this length.
  double density_in_world(double length) const;
  Rgb scale_{1};
  Imath::M33f to_light_, to_world_;
  double volume_ = 0;  ///< |det to_world_| of a map if that changes angles; 0: it does not
  std::shared_ptr<const EnvironmentMap> map_;  ///< null: constant
  std::shared_ptr<Arcs> arcs_;                 ///< of the map
  std::shared_ptr<const Portal> portal_;
};

}  // namespace penumbra
