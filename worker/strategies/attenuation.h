#pragma once
// What lies in the way of light without being a surface, as the loop over strategies asks for it.
#include "scenes/math.h"

namespace penumbra {

/// A stage of DirectLight; none where light passes unhindered. It knows of itself what lies about the shading
/// point that is being lit.
class Attenuation {
 public:
  virtual ~Attenuation() = default;
  /// The share, per channel, of light from `distance` (infinite: from infinitely far away) along unit wi that
  /// arrives at x, whatever the surfaces between: those have been asked before.
  virtual Rgb transmittance(const Vec3f& x, const Vec3f& wi, double distance) const = 0;
};

}  // namespace penumbra
