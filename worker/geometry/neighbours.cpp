#include "worker/geometry/neighbours.h"

#include <algorithm>

namespace penumbra {
namespace {

/// Calls meets(leaf) for the leaves whose box meets [lo, hi], until one says yes.
template <class Meets>
bool any_leaf(const LineTree& tree, const Vec3d& lo, const Vec3d& hi, Meets meets) {
  if (tree.nodes.empty()) return false;
  const Vec3d from = lo - tree.centre, to = hi - tree.centre;
  std::vector<uint32_t> stack{0};
  while (!stack.empty()) {
    const LineNode& node = tree.nodes[stack.back()];
    stack.pop_back();
    for (int lane = 0; lane < kWidth; ++lane) {
      bool overlaps = true;
      for (int k = 0; k < 3; ++k) overlaps &= node.lo[k][lane] <= to[k] && node.hi[k][lane] >= from[k];
      if (!overlaps) continue;
      if ((node.leaves >> lane & 1) == 0)
        stack.push_back(node.child[lane]);
      else if (meets(node.child[lane]))
        return true;
    }
  }
  return false;
}

/// Unused lanes are points.
bool lane_meets(const TriangleBlock& block, int lane, const Vec3d& lo, const Vec3d& hi) {
  bool point = true, overlaps = true;
  for (int k = 0; k < 3; ++k) {
    const auto [least, most] = std::minmax({block.p[0][k][lane], block.p[1][k][lane], block.p[2][k][lane]});
    point &= least == most;
    overlaps &= least <= hi[k] && most >= lo[k];
  }
  return overlaps && !point;
}

}  // namespace

bool anything_meets(const LineBvh& bvh, const Vec3d& lo, const Vec3d& hi, const Excluded& own) {
  if (any_leaf(bvh.instance_tree, lo, hi, [](uint32_t) { return true; })) return true;
  return any_leaf(bvh.world, lo, hi, [&](uint32_t index) {
    const TriangleBlock& block = bvh.world.blocks[index];
    for (int lane = 0; lane < kWidth; ++lane)
      if (!own.holds(block.id[lane]) && lane_meets(block, lane, lo, hi)) return true;
    return false;
  });
}

}  // namespace penumbra
