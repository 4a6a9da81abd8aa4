#pragma once
// Surfaces that rays pass: where a ray crosses them and from which side. Knows nothing of what they bound.
#include <memory>
#include <span>
#include <vector>

#include "absl/status/statusor.h"
#include "scenes/mesh.h"
#include "worker/geometry/geometry.h"

namespace penumbra {

struct Crossing {
  float distance = 0;  ///< along the ray, in lengths of its direction
  uint32_t mesh = 0;
  float cosine = 0;  ///< between the ray and the surface's normal, not negative
  /// The ray comes from the side from which the vertices go round counterclockwise.
  bool from_front = false;
};

class CrossingScene {
 public:
  /// Copies the meshes, which are in the world.
  static absl::StatusOr<CrossingScene> build(std::span<const TriangleMesh> meshes, int threads);
  CrossingScene(CrossingScene&&) noexcept;
  CrossingScene& operator=(CrossingScene&&) noexcept;
  ~CrossingScene();

  /// All crossings in (near, far], by distance; an edge between two triangles may count once or twice. `out`
  /// is replaced.
  void crossings(const Ray& ray, std::vector<Crossing>& out) const;

 private:
  CrossingScene();
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace penumbra
