#pragma once
// The part of a ray that a spot light shines on.
#include "scenes/math.h"
#include "worker/lights/emitter.h"

namespace penumbra {

/// Cuts [t0,t1] of the ray origin + t direction (direction of any length) to where the spot may shine: not
/// less than that, and more by the rounding of its cone in single precision at most. False: nowhere. A cone
/// of more than a half space cuts nothing.
bool clip_to_cone(const SpotEmitter& spot, const Vec3d& origin, const Vec3d& direction, double& t0,
                  double& t1);

}  // namespace penumbra
