#include "worker/geometry/line_tree.h"

#include <algorithm>
#include <cmath>

namespace penumbra {
namespace {

void set_lane(PairBlock& block, uint32_t lane, const PairList::Item& item) {
  const PairCorners corners = corners_of(*item.mesh, item.pair);
  for (int c = 0; c < 4; ++c)
    for (int k = 0; k < 3; ++k) block.p[c][k][lane] = item.mesh->positions[corners.index[c]][k];
  block.id[0][lane] = item.first_id + item.pair.first;
  block.id[1][lane] = item.pair.alone() ? kNone : item.first_id + item.pair.second;
  for (int which = 0; which < 2; ++which) block.order[which][lane] = corners.order[which];
}

/// Copies a built tree into arrays, depth first; leaves become blocks of pairs, or instances or segments:
/// of several in one leaf each has its box in a node of their own.
class Flattener {
 public:
  Flattener(LineTree& tree, std::span<const Box> boxes, const PairList* pairs)
      : tree_(tree), boxes_(boxes), pairs_(pairs) {}

  void root(const BuiltNode& node, const Box& bounds) {
    for (int k = 0; k < 3; ++k) tree_.centre[k] = 0.5 * (double{bounds.lo[k]} + bounds.hi[k]);
    tree_.radius = 0.5 * (Vec3d(bounds.hi) - Vec3d(bounds.lo)).length();
    // Counted first: arrays that grow are copied, and their pages cleared, once more than they need to be.
    size_t nodes = node.leaf ? 1 : 0, leaves = 0;
    count(node, nodes, leaves);
    tree_.nodes.reserve(nodes);
    if (is_bundle(node)) {
      bundle(static_cast<const BuiltLeaf&>(node), 1);
      return;
    }
    if (pairs_ != nullptr) tree_.blocks.reserve(leaves);
    if (!node.leaf) {
      inner(static_cast<const BuiltInner&>(node), 1);
      return;
    }
    BuiltInner single;
    single.count = 1;
    single.children[0] = const_cast<BuiltNode*>(&node);
    single.bounds[0] = bounds;
    inner(single, 1);
  }

 private:
  uint32_t inner(const BuiltInner& built, uint32_t depth) {
    tree_.depth = std::max(tree_.depth, depth);
    const auto index = static_cast<uint32_t>(tree_.nodes.size());
    tree_.nodes.emplace_back();
    LineNode node;
    for (int lane = 0; lane < kWidth; ++lane) set_bounds(node, lane, empty_box());
    for (uint32_t lane = 0; lane < built.count; ++lane) {
      set_bounds(node, static_cast<int>(lane), built.bounds[lane]);
      const BuiltNode& child = *built.children[lane];
      if (is_bundle(child)) {
        node.child[lane] = bundle(static_cast<const BuiltLeaf&>(child), depth + 1);
        continue;
      }
      if (child.leaf) node.leaves |= 1u << lane;
      node.child[lane] = child.leaf ? leaf(static_cast<const BuiltLeaf&>(child))
                                    : inner(static_cast<const BuiltInner&>(child), depth + 1);
    }
    for (uint32_t lane = built.count; lane < kWidth; ++lane) node.child[lane] = 0;
    tree_.nodes[index] = node;
    return index;
  }

  bool is_bundle(const BuiltNode& node) const {
    return node.leaf && pairs_ == nullptr && static_cast<const BuiltLeaf&>(node).count > 1;
  }

  uint32_t bundle(const BuiltLeaf& many, uint32_t depth) {
    BuiltLeaf singles[kWidth];
    BuiltInner node;
    node.count = many.count;
    for (uint32_t i = 0; i < many.count; ++i) {
      singles[i].leaf = true;
      singles[i].count = 1;
      singles[i].items[0] = many.items[i];
      node.children[i] = &singles[i];
      node.bounds[i] = boxes_[many.items[i]];
    }
    return inner(node, depth);
  }

  void count(const BuiltNode& node, size_t& nodes, size_t& leaves) const {
    ++(node.leaf && !is_bundle(node) ? leaves : nodes);
    if (node.leaf) return;
    const auto& built = static_cast<const BuiltInner&>(node);
    for (uint32_t lane = 0; lane < built.count; ++lane) count(*built.children[lane], nodes, leaves);
  }

  uint32_t leaf(const BuiltLeaf& built) {
    if (pairs_ == nullptr) return built.items[0];
    PairBlock& block = tree_.blocks.emplace_back();
    for (uint32_t lane = 0; lane < built.count; ++lane) {
      const PairList::Item& item = pairs_->items[built.items[lane]];
      set_lane(block, lane, item);
      tree_.triangles += item.pair.alone() ? 1 : 2;
    }
    block.finish(static_cast<int>(built.count));
    return static_cast<uint32_t>(tree_.blocks.size() - 1);
  }

  void set_bounds(LineNode& node, int lane, const Box& box) const {
    for (int k = 0; k < 3; ++k) {
      const double lo = box.lo[k] - tree_.centre[k], hi = box.hi[k] - tree_.centre[k];
      node.lo[k][lane] = std::nextafter(static_cast<float>(lo), -kInfinity);
      node.hi[k][lane] = std::nextafter(static_cast<float>(hi), kInfinity);
    }
  }

  LineTree& tree_;
  std::span<const Box> boxes_;
  const PairList* pairs_;
};

Box bounds_of(std::span<const Box> boxes) {
  Box all = empty_box();
  for (const Box& b : boxes) {
    extend(all, b.lo);
    extend(all, b.hi);
  }
  return all;
}

}  // namespace

void PairList::add(const TriangleMesh& mesh, uint32_t first_id) {
  pairs_.clear();
  append_pairs(mesh, pairs_);
  for (const TrianglePair& pair : pairs_) {
    Box box = empty_box();
    for (const uint32_t triangle : {pair.first, pair.second})
      for (int c = 0; c < 3; ++c) extend(box, mesh.positions[mesh.indices[3 * size_t{triangle} + c]]);
    items.push_back({&mesh, pair, first_id});
    boxes.push_back(box);
  }
}

absl::Status build_tree(std::span<const Box> boxes, const PairList* pairs, TreeBuilder& builder,
                        LineTree& tree, int leaf_size) {
  if (boxes.empty()) return absl::OkStatus();
  return builder.build(boxes, leaf_size, [&](const BuiltNode& root) {
    Flattener(tree, boxes, pairs).root(root, bounds_of(boxes));
  });
}

}  // namespace penumbra
