#pragma once
// From boxes to one tree of the line hierarchy: what Embree's builder makes, laid out as walks want it.
#include <limits>
#include <span>
#include <vector>

#include "worker/geometry/bvh_builder.h"
#include "worker/geometry/triangle_pairs.h"

namespace penumbra {

inline constexpr float kInfinity = std::numeric_limits<float>::infinity();

inline void extend(Box& box, const Vec3f& p) {
  for (int k = 0; k < 3; ++k) {
    box.lo[k] = std::min(box.lo[k], p[k]);
    box.hi[k] = std::max(box.hi[k], p[k]);
  }
}

constexpr Box empty_box() {
  return {Vec3f(kInfinity, kInfinity, kInfinity), -Vec3f(kInfinity, kInfinity, kInfinity)};
}

/// The triangles of some meshes in pairs, by numbers of their own.
struct PairList {
  struct Item {
    const TriangleMesh* mesh;
    TrianglePair pair;
    uint32_t first_id;  ///< of the mesh's first triangle
  };
  std::vector<Item> items;
  std::vector<Box> boxes;

  void reserve(size_t count) {
    items.reserve(count);
    boxes.reserve(count);
  }

  /// Keeps the mesh's address.
  void add(const TriangleMesh& mesh, uint32_t first_id);

 private:
  std::vector<TrianglePair> pairs_;
};

/// A tree over boxes, of at most `leaf_size` (<= kWidth) in one leaf: the pairs' blocks, or, without pairs,
/// the boxes' numbers, of which each has its box in a node. No boxes: an empty tree. Errors: those of
/// TreeBuilder.
absl::Status build_tree(std::span<const Box> boxes, const PairList* pairs, TreeBuilder& builder,
                        LineTree& tree, int leaf_size);

}  // namespace penumbra
