#pragma once
// What lies in the way of light without being a surface, as the loop over strategies asks for it.
#include "worker/strategies/shading_point.h"

namespace penumbra {

/// A stage of DirectLight; none where light passes unhindered.
class Attenuation {
 public:
  virtual ~Attenuation() = default;
  /// The share, per channel, of light from `distance` (infinite: from infinitely far away) along unit wi that
  /// arrives at the point, whatever the surfaces between: those have been asked before.
  virtual Rgb transmittance(const ShadingPoint& point, const Vec3f& wi, double distance) const = 0;
};

}  // namespace penumbra
