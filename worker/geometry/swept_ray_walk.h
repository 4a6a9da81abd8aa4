#pragma once
// The walk of a ray through time: what it meets first at each time of the shutter.
#include <vector>

#include "worker/geometry/line_bvh.h"

namespace penumbra {

/// See Geometry::nearest.
void nearest_in_time(const LineBvh& bvh, const RayInTime& ray, std::vector<SeenInterval>& out,
                     QueryCounters& counters);

}  // namespace penumbra
