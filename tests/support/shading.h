#pragma once
// A shading point of a scene, as the path tracer makes it: for tests of what happens at one.
#include <memory>

#include "worker/materials/bsdf.h"
#include "worker/render/scene.h"
#include "worker/render/surface.h"
#include "worker/strategies/direct_light.h"

namespace penumbra::test {

/// Where a ray meets the scene. Keeps what a ShadingPoint refers to.
class Met {
 public:
  Met(const Scene& scene, const Vec3f& origin, const Vec3f& direction) {
    QueryCounters counters;
    const Vec3f d = direction.normalized();
    const auto hit =
        scene.geometry->intersect({origin, d, 0, std::numeric_limits<float>::infinity()}, counters);
    if (!hit) return;
    surface_ = surface_at(scene, *hit, d, nullptr);
    bsdf_ = std::make_unique<Bsdf>(
        scene.materials.shade(scene.meshes[hit->id.mesh].material, surface_, scene.textures));
    point_ = std::make_unique<ShadingPoint>(surface_, *bsdf_);
  }
  explicit operator bool() const { return point_ != nullptr; }
  const ShadingPoint& point() const { return *point_; }

 private:
  SurfacePoint surface_;
  std::unique_ptr<Bsdf> bsdf_;
  std::unique_ptr<ShadingPoint> point_;
};

}  // namespace penumbra::test
