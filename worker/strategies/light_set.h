#pragma once
// All lights of a scene, and how they are found: from a hit of a ray, or by drawing.
#include <cstdint>
#include <optional>
#include <vector>

#include "worker/effects/environment.h"
#include "worker/geometry/geometry.h"
#include "worker/lights/emitter.h"

namespace penumbra {

class LightSet {
 public:
  /// Up to this many lights every one is asked at every shading point; above, that many are drawn.
  static constexpr int kMostAsked = 16;

  std::vector<AreaEmitter> area;
  std::vector<Environment> environments;
  std::vector<DeltaEmitter> delta;
  /// Shafts may answer for lines and shadow rays (LightSight). Tests turn it off: the images must not differ.
  bool shafts = true;

  /// How the triangles of a mesh map to area emitters.
  struct MeshLights {
    uint32_t first = kNone;       ///< index into area; kNone: the mesh does not emit
    bool per_primitive = false;   ///< each triangle is an emitter of its own
    bool two_sided = false;       ///< then emitters come in pairs: front, back
  };
  std::vector<MeshLights> by_mesh;

  /// To be called when the lists are complete. `reach` is the scene's diameter.
  void finish(float reach);
  float reach() const { return reach_; }

  /// The area emitter that radiates from the point p of the hit surface against the ray's direction;
  /// kNone if there is none.
  uint32_t emitter_at(const PrimitiveId& hit, const Vec3d& p, const Vec3f& direction) const;

  size_t size() const { return area.size() + environments.size() + delta.size(); }
  bool draws() const { return size() > size_t(kMostAsked); }
  /// A light (area first, then environments, then delta) with probability proportional to its power.
  size_t draw(double u) const;
  double probability(size_t light) const;

 private:
  float reach_ = 0;
  std::vector<double> sums_;  ///< running sums of power
};

}  // namespace penumbra
