#pragma once
#include "worker/render/scene.h"

namespace penumbra {

/// The surface where a ray along `direction` (unit) has met a tube. u runs along the curve, v across it: v =
/// (1 + h)/2, h the ray's offset from the axis in radii. Footprints are unknown.
SurfacePoint tube_surface_at(const Tubes& tubes, const Hit& hit, const Vec3f& direction);

}  // namespace penumbra
