#pragma once
// The walk of a bow-tie through the hierarchy of the line queries: what each of its rays meets first.
#include <vector>

#include "worker/geometry/line_bvh.h"
#include "worker/geometry/lower_envelope.h"

namespace penumbra {

/// See Geometry::nearest.
void nearest_along(const LineBvh& bvh, const FocusedChord& chord, std::vector<SeenInterval>& out,
                   QueryCounters& counters);

/// An envelope over a scene's triangles as Geometry gives it: neighbours of one triangle are one interval.
void seen_of(const LineBvh& bvh, const LowerEnvelope& envelope, std::vector<SeenInterval>& out);

}  // namespace penumbra
