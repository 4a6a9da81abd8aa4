#pragma once
// One participating medium: coefficients per length, density, phase function; and where along a ray it
// scatters.
#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "scenes/description.h"
#include "scenes/files.h"
#include "worker/effects/density.h"
#include "worker/effects/equiangular.h"
#include "worker/effects/henyey_greenstein.h"

namespace penumbra {

struct Medium {
  Vec3d sigma_t{0, 0, 0},
      sigma_s{0, 0, 0};  ///< extinction and scattering at density 1, length⁻¹, per channel
  HenyeyGreenstein phase;
  Density density;

  bool scatters() const { return sigma_s.x > 0 || sigma_s.y > 0 || sigma_s.z > 0; }
};

/// exp(-sigma_t × column); 1 for a channel without extinction, however long the way.
Vec3d transmittance(const Medium& medium, double column);

/// A place of a ray where light may be scattered, and how it was found.
struct ScatterPoint {
  double t = 0;
  double column = 0;   ///< from the ray's t0
  double density = 0;  ///< there
};

/// Distances in proportion to what is scattered of light that comes from the ray's t0: density ×
/// transmittance, all within [t0,t1]. Every channel that scatters has an equal share. Made once per ray;
/// refers to the medium.
class FreeFlight {
 public:
  FreeFlight(const Medium& medium, const MediumRay& ray);
  /// Column of the whole ray; the density of sample() is 0 everywhere where it is 0.
  double column() const { return column_; }
  /// u chooses the distance, `choice` the channel; both in [0,1). Only where pdf() can be > 0.
  ScatterPoint sample(double u, double choice) const;
  /// Density of sample() per length at a point of the ray.
  double pdf(const ScatterPoint& at) const;
  /// What is known of the point at t.
  ScatterPoint point(double t) const;
  bool possible() const { return column_ > 0 && channels_ > 0; }

 private:
  const Medium& medium_;
  MediumRay ray_;
  double column_ = 0;
  int channels_ = 0;  ///< that scatter
};

/// From `MakeNamedMedium`. Null: of a kind that is not supported (unsupported() says so); InvalidArgument
/// (`file:line:column: …`) for coefficients below 0, |g| ≥ 1, a grid that does not have its numbers.
absl::StatusOr<std::unique_ptr<Medium>> build_medium(const MediumEntity& entity,
                                                     const SceneDescription& description,
                                                     const SceneFiles& files);

}  // namespace penumbra
