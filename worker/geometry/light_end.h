#pragma once
// The end of a shadow segment on a flat light: what a ray meets close to the light is judged in double
// precision, because a ray's own distances do not tell a cover in front of a light from one behind it.
#include <Imath/ImathBox.h>

#include "worker/geometry/geometry.h"

namespace penumbra {

/// One segment from x to a point of a flat light, to which it keeps a reference.
class LightApproach {
 public:
  LightApproach(const Vec3f& x, const LightEnd& end);

  /// A surface that a ray meets at less than 1 - doubt() of the way hides the light; at more than 1 + doubt()
  /// it does not. Between, hides() decides.
  float doubt() const { return doubt_; }

  /// Does the surface hide the end, given that a ray met it on its way? `surface`: the triangle met; `light`:
  /// bounds of the light's vertices.
  bool hides(const Vec3d surface[3], const Imath::Box3f& light) const;

 private:
  const LightEnd& end_;
  Vec3d way_;      ///< from x to the end
  double height_;  ///< of x over the light's plane
  float doubt_;
};

}  // namespace penumbra
