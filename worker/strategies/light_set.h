#pragma once
// All lights of a scene, and how they are found: from a hit of a ray, or by drawing.
#include <Imath/ImathBox.h>

#include <cstdint>
#include <optional>
#include <vector>

#include "worker/effects/environment.h"
#include "worker/geometry/geometry.h"
#include "worker/lights/emitter.h"
#include "worker/lights/light_tree.h"

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
    uint32_t first = kNone;      ///< index into area; kNone: the mesh does not emit
    bool per_primitive = false;  ///< each triangle is an emitter of its own
    bool two_sided = false;      ///< then emitters come in pairs: front, back
    uint32_t instance = kNone;   ///< that carries it, if it moves
  };
  std::vector<MeshLights> by_mesh;

  /// Meshes with flat lights that stand and that something else is very close to (AreaEmitter::crowded), and
  /// the bounds of these lights; none: the list is empty.
  std::vector<bool> crowded;
  Imath::Box3d crowded_bounds;

  /// To be called when the lists are complete. `reach` is the diameter of what can hide light, `centre` the
  /// middle of its bounds.
  void finish(float reach, const Vec3f& centre);
  /// From a surface, past everything.
  float reach() const { return reach_; }
  /// From anywhere, past everything: fog has no surface, and reaches farther than what has.
  float reach_from(const Vec3f& x) const;
  const Vec3f& centre() const { return centre_; }

  /// The area emitter that radiates from the point p of the hit surface against the ray's direction, at a
  /// time of the shutter; kNone if there is none.
  uint32_t emitter_at(const PrimitiveId& hit, const Vec3d& p, const Vec3f& direction, float time) const;

  size_t size() const { return area.size() + environments.size() + delta.size(); }
  bool draws() const { return size() > size_t(kMostAsked); }
  /// A light (area first, then environments, then delta) with probability by its estimated contribution: the
  /// near ones from a tree, those infinitely far away one by one. Only if draws().
  DrawnLight draw(const Receiver& receiver, double u) const;
  double probability(const Receiver& receiver, size_t light) const;

 private:
  bool is_far(size_t light) const;
  /// Irradiance, at most, at the receiver by the far light.
  double far_irradiance(size_t light, const Receiver& receiver) const;
  double far_irradiance(const Receiver& receiver) const;
  /// Probability that a far light is drawn, given the sum of their irradiances.
  double share_of_far(double far, const Receiver& receiver) const;

  float reach_ = 0;
  Vec3f centre_{0};
  LightTree tree_;
  std::vector<uint32_t> near_, far_;  ///< lights, in the tree's order; lights infinitely far away
  std::vector<uint32_t> place_;       ///< per light: its place in near_
};

}  // namespace penumbra
