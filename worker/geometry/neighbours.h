#pragma once
// What lies close to a light, found once per light.
#include "worker/geometry/line_bvh.h"

namespace penumbra {

/// Does the bounding box of any opaque triangle but `own`, or of any instance, meet the box?
bool anything_meets(const LineBvh& bvh, const Vec3d& lo, const Vec3d& hi, const Excluded& own);

}  // namespace penumbra
