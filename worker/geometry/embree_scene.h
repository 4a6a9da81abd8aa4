#pragma once
// Rays: nearest hit and shadow segments, by Embree. This header knows nothing of it.
#include <memory>
#include <span>

#include "worker/geometry/geometry.h"

namespace penumbra {

class EmbreeScene {
 public:
  static absl::StatusOr<std::unique_ptr<EmbreeScene>> build(std::span<const MeshInput> meshes,
                                                            std::span<const ObjectInput> objects,
                                                            std::span<const InstanceInput> instances,
                                                            int threads);
  ~EmbreeScene();

  std::optional<Hit> intersect(const Ray& ray) const;
  bool occluded(const Vec3f& x, const Vec3f& y) const;
  bool occluded(const Vec3f& x, const LightEnd& y) const;
  bool occluded_by_alpha(const Vec3f& x, const LightEnd& y) const;
  bool has_alpha() const;
  void bounds(Vec3f& lo, Vec3f& hi) const;

 private:
  EmbreeScene();
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace penumbra
