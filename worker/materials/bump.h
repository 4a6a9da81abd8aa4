#pragma once
#include "worker/materials/material_kinds.h"

namespace penumbra {

/// The point with the shading frame (ns, dpdu, dpdv) of its material's displaced surface: the height
/// texture's gradient by differences (Blinn 1978, pbrt-v3 §9.3), or v4's normal map.
SurfacePoint displaced(const Material& material, const SurfacePoint& point, const Textures& textures);

}  // namespace penumbra
