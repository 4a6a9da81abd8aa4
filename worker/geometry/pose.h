#pragma once
// Where a moving instance is at one time. A camera sample asks for the same few poses again and again, at its
// one time: each thread keeps the last ones.
#include "scenes/animated_transform.h"

namespace penumbra {

struct Pose {
  Matrix to_world, to_object;
  Imath::M33d normals;  ///< inverse transpose of to_world's linear part, for row vectors
};

/// At a time in [0,1] of the shutter. Valid until this thread asks for another pose.
const Pose& pose_at(const AnimatedTransform& motion, float time);

}  // namespace penumbra
