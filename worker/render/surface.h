#pragma once
// From a hit to the surface point that shading needs.
#include "worker/geometry/surface_point.h"
#include "worker/render/camera.h"
#include "worker/render/scene.h"

namespace penumbra {

/// The surface at a hit of a ray with unit direction; wo = -direction. `footprint`: the camera ray whose
/// pixel's footprint textures are to be filtered over; null: none.
///
/// Where the neighbouring rays meet the tangent plane gives the footprint, scaled to a quarter of a pixel
/// whatever the number of passes: pbrt shrinks its footprint with the samples per pixel, but then the image
/// that a run converges to would depend on its budget.
SurfacePoint surface_at(const Scene& scene, const Hit& hit, const Vec3f& direction, const CameraRay* footprint);

}  // namespace penumbra
