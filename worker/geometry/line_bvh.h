#pragma once
// The hierarchy that line queries walk: 16-wide nodes over blocks of 16 pairs of triangles, one layout for
// every instruction set, so that all of them visit the same boxes in the same order.
#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "worker/geometry/aligned.h"
#include "worker/geometry/geometry.h"
#include "worker/geometry/line_fan.h"
#include "worker/geometry/pair_block.h"
#include "worker/geometry/pose.h"

namespace penumbra {

struct Box {
  Vec3f lo, hi;
};

/// Bounds of 16 children, relative to the tree's centre and rounded outwards; unused lanes are empty boxes.
struct alignas(64) LineNode {
  float lo[3][kWidth], hi[3][kWidth];  ///< six rows, one after another
  uint32_t child[kWidth];              ///< of a leaf: its block (or instance); else a node
  uint32_t leaves = 0;                 ///< bit k: child k is a leaf
};

/// A tree in its own coordinates: of the world's meshes, of one object's, or of the instances.
struct LineTree {
  AlignedVector<LineNode> nodes;  ///< [0] is the root; empty: nothing here
  AlignedVector<PairBlock> blocks;
  Vec3d centre;        ///< of its bounds; nodes are relative to it
  double radius = 0;   ///< |p - centre| of everything inside
  uint32_t depth = 0;  ///< of nodes on a path
  size_t triangles = 0;

  /// No vertex is farther from x.
  double reach(const Vec3d& x) const { return (x - centre).length() + radius; }
};

/// An object placed in the world.
struct LineInstance {
  uint32_t tree = 0;  ///< into LineBvh::objects
  Matrix to_object;   ///< affine, row vectors; of one that moves, at time 0
  std::shared_ptr<const AnimatedTransform> motion;

  /// Valid until this thread asks for that of another instance.
  const Matrix& to_object_at(float time) const {
    return motion ? pose_at(*motion, time).to_object : to_object;
  }
};

/// Segments of tubes, in the world; leaves are single segments.
struct LineTubes {
  LineTree tree;
  std::vector<const Imath::V4f*> segments;  ///< the two points of each begin here
  std::vector<uint32_t> meshes, first_segment;  ///< the meshes that they are of, in order, and where each begins
};

struct LineBvh {
  uint64_t id = 0;  ///< of this hierarchy, in this process
  LineTree world;
  std::vector<LineTree> objects;
  LineTree instance_tree;  ///< leaves are single instances
  std::vector<LineInstance> instances;
  LineTubes tubes;
  std::vector<uint32_t> first_triangle;  ///< of each mesh, in a numbering of all meshes' triangles

  /// Nodes on the longest path, through instances as well.
  uint32_t depth() const;
  size_t bytes() const;
  size_t triangles() const;
};

/// What of the query's light lies in a tree: the world's (instance kNone) or a placed object's.
inline Excluded excluded_in(const LineBvh& bvh, const LineQuery& query, uint32_t instance) {
  if (query.light.mesh == kNone || query.light.instance != instance) return {};
  return {bvh.first_triangle[query.light.mesh] + query.light.primitive, query.light_primitives};
}

/// InvalidArgument for an instance whose transform is singular or not finite, ResourceExhausted beyond 2^32
/// triangles.
absl::Status check_line_input(std::span<const MeshInput> meshes, std::span<const InstanceInput> instances);

/// Errors: those of check_line_input(), ResourceExhausted where memory runs out.
absl::StatusOr<LineBvh> build_line_bvh(std::span<const MeshInput> meshes,
                                       std::span<const ObjectInput> objects,
                                       std::span<const InstanceInput> instances, int threads);

}  // namespace penumbra
