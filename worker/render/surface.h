#pragma once
// From a hit to the surface point that shading needs.
#include "worker/geometry/surface_point.h"
#include "worker/render/camera.h"
#include "worker/render/scene.h"

namespace penumbra {

/// The surface at a hit of a ray with unit direction; wo = -direction.
SurfacePoint surface_at(const Scene& scene, const Hit& hit, const Vec3f& direction);

/// Fills the pixel's footprint at a camera ray's hit: where the neighbouring rays meet the tangent plane.
/// Scaled to a quarter of a pixel, whatever the number of passes: pbrt shrinks its footprint with the
/// samples per pixel, but then the image that a run converges to would depend on its budget.
void set_footprint(SurfacePoint& point, const CameraRay& ray);

}  // namespace penumbra
