#pragma once
// The walk of a bow-tie through the hierarchy of the line queries: what each of its rays meets first.
#include <vector>

#include "worker/geometry/line_bvh.h"

namespace penumbra {

/// See Geometry::nearest.
void nearest_along(const LineBvh& bvh, const FocusedChord& chord, std::vector<SeenInterval>& out,
                   QueryCounters& counters);

}  // namespace penumbra
