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

namespace penumbra {

struct EnvironmentSample {
  Vec3f wi;        ///< unit, world space
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
  /// Mean radiance over the sphere, for choosing among lights.
  double mean_luminance() const;

 private:
  struct Map;
  Rgb scale_{1};
  Imath::M33f to_light_, to_world_;
  std::shared_ptr<const Map> map_;  ///< empty: constant
};

}  // namespace penumbra
