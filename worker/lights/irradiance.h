#pragma once
// Irradiance from flat lights of radiance 1 in closed form (Lambert 1760; Arvo 1995): the diffuse term of a
// shading point whose light nothing hides, or one triangle does.
#include <array>

#include "worker/lights/shape.h"

namespace penumbra {

/// Has the shape a closed form here: quads and triangles.
bool has_irradiance(const LightShape& shape);

/// ∫ max(0, n·ω) dω over the shape as seen from x, clipped to the horizon of unit normal n; unitless, in
/// [0,π]. 0 for a shape seen from behind. The shape must have_irradiance.
double irradiance(const LightShape& shape, const Vec3d& x, const Vec3d& n);

/// The same over the part that the opaque triangle does not hide. The triangle may lie anywhere: behind x and
/// beyond the light it hides nothing.
double irradiance_behind(const LightShape& shape, const Vec3d& x, const Vec3d& n,
                         const std::array<Vec3d, 3>& occluder);

}  // namespace penumbra
