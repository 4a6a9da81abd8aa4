#pragma once
// Area lights that move: at a time of the shutter everything stands still, and so do they.
#include "scenes/animated_transform.h"
#include "worker/lights/emitter.h"
#include "worker/lights/light_bounds.h"

namespace penumbra {

struct LightMotion {
  LightShape in_object;
  AnimatedTransform to_world;  ///< of spheres, disks and cylinders similarities at all times
};

/// A shape under an affine transform, which must be a similarity for what is round. It emits to where the
/// transform takes its emission side: that of quads and triangles from the order of their edges, so a
/// transform that mirrors turns it, that of the others along.
LightShape moved(const LightShape& shape, const Matrix& to_world);

/// A moving emitter as it stands at a time u in [0,1] of the shutter; emitter.motion must not be null. What
/// is close to it is judged at every sample (crowded): elsewhere it may be elsewhere.
AreaEmitter standing_at(const AreaEmitter& emitter, double u);

/// Bounds for all times, of all directions.
LightBounds bounds_of_moving(const AreaEmitter& emitter);

}  // namespace penumbra
