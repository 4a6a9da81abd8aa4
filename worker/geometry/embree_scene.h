#pragma once
// Rays: nearest hit and shadow segments, by Embree. This header knows nothing of it.
#include <Imath/ImathBox.h>

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
  void beside(const Ray& ray, const Hit& first, const std::vector<bool>& marked,
              std::vector<Meeting>& out) const;
  bool occluded(const Vec3f& x, const Vec3f& y, float time) const;
  bool occluded(const Vec3f& x, const LightEnd& y) const;
  bool occluded_by_alpha(const Vec3f& x, const Vec3f& y, float time) const;
  bool occluded_by_alpha(const Vec3f& x, const LightEnd& y) const;
  bool has_alpha() const;
  bool in_hole(const PrimitiveId& first, uint32_t primitives, const Vec3d& p, float time) const;
  /// Do the bounds of any triangle, or of an instance that moves at any time, meet the box, but those of a
  /// light's own `primitives`?
  /// Nor does what lies with the light in one plane and mesh count.
  bool anything_meets(const Imath::Box3d& box, const PrimitiveId& own, uint32_t primitives,
                      const LightPlane& plane) const;
  void bounds(Vec3f& lo, Vec3f& hi) const;
  /// Of `primitives` triangles from the given one on; not of instances.
  Imath::Box3f bounds(const PrimitiveId& first, uint32_t primitives) const;

 private:
  EmbreeScene();
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace penumbra
