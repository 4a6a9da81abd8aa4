#pragma once
// The walk of a line query through the hierarchy, sixteen boxes or triangles at a time. Included by one file
// per instruction set.
#include "worker/geometry/fan_block.h"
#include "worker/geometry/fan_boxes.h"
#include "worker/geometry/line_query.h"
#include "worker/geometry/visible_set.h"

namespace penumbra {
namespace {

class LineWalk {
 public:
  LineWalk(const LineBvh& bvh, LineWorkspace& workspace, QueryCounters& counters)
      : bvh_(bvh), workspace_(workspace), counters_(counters), visible_(workspace) {}

  void run(const LineQuery& query, IntervalSet& out) {
    query_ = &query;
    visible_.reset();
    widest_ = 0;
    const Vec3d x(query.x), a = Vec3d(query.a) - x, b = Vec3d(query.b) - x;
    const LineTree& frame = bvh_.world.nodes.empty() ? bvh_.instance_tree : bvh_.world;
    const LightPlane plane = chord_plane(query);
    const LineFan fan = make_fan(x, a, b, frame.nodes.empty() ? 0 : frame.reach(x), plane);
    out.clear();
    if (fan.degenerate) return;  // a chord seen end on has no width to be seen by
    if (!bvh_.world.nodes.empty()) {
      triangles(bvh_.world, fan, excluded_in(bvh_, query, kNone), workspace_.stack.data(),
                workspace_.leaves.data());
    }
    if (!bvh_.instance_tree.nodes.empty() && !visible_.empty()) placed_objects(x, a, b, plane);
    // A neighbour of a lit point is mostly lit: then there is nothing to try first.
    workspace_.occluder_tree = widest_ > 0 && occluder_world_ ? bvh_.id : 0;
    workspace_.occluder = occluder_;
    for (int i = 0; i < visible_.size(); ++i) out.append(visible_[i].lo, visible_[i].hi);
  }

 private:
  void placed_objects(const Vec3d& x, const Vec3d& a, const Vec3d& b, const LightPlane& plane) {
    const LineFan fan = make_fan(x, a, b, bvh_.instance_tree.reach(x), plane);
    walk(bvh_.instance_tree, fan, workspace_.stack.data(), workspace_.leaves.data(),
         [&](const uint32_t* found, int count, uint32_t* stack, uint32_t* leaves) {
           for (int i = 0; i < count && !visible_.empty(); ++i) {
             const LineInstance& placed = bvh_.instances[found[i]];
             const LineTree& tree = bvh_.objects[placed.tree];
             Vec3d ox, oa, ob;
             placed.to_object.multVecMatrix(x, ox);
             placed.to_object.multDirMatrix(a, oa);
             placed.to_object.multDirMatrix(b, ob);
             const LineFan object_fan =
                 make_fan(ox, oa, ob, tree.reach(ox), placed_plane(plane, a, b, placed.to_object));
             if (object_fan.degenerate) continue;
             triangles(tree, object_fan, excluded_in(bvh_, *query_, found[i]), stack, leaves);
           }
         });
  }

  void triangles(const LineTree& tree, const LineFan& fan, const Excluded& excluded, uint32_t* stack_base,
                 uint32_t* leaves_base) {
    const FanBlock fan_block(fan);
    const bool world = &tree == &bvh_.world;
    if (world && workspace_.occluder_tree == bvh_.id) {
      test(fan_block, tree, {&workspace_.occluder, 1}, excluded, visible_.hull());
      if (visible_.empty()) return;
    }
    walk(tree, fan, stack_base, leaves_base, [&](const uint32_t* found, int count, uint32_t*, uint32_t*) {
      test(fan_block, tree, {found, static_cast<size_t>(count)}, excluded, visible_.hull());
    });
  }

  /// Takes from the visible set what some blocks hide of it.
  void test(const FanBlock& fan_block, const LineTree& tree, std::span<const uint32_t> blocks,
            const Excluded& excluded, Interval hull) {
    for (const uint32_t block : blocks) {
      if (fan_block.hidden(tree.blocks[block], excluded, hull.lo, hull.hi, hidden_, widest_)) {
        occluder_ = block;
        occluder_world_ = &tree == &bvh_.world;
      }
    }
    counters_.triangles_tested += kWidth * blocks.size();
    fan_block.settle(hidden_, hull.lo, hull.hi);
    if (!hidden_.empty() && hidden_.flush(visible_)) ++version_;
  }

  /// Visits the leaves that the visible part of the fan meets. `use` may narrow it, and gets the free parts
  /// of the two buffers for a walk of its own.
  template <class Use>
  void walk(const LineTree& tree, const LineFan& fan, uint32_t* stack_base, uint32_t* leaves, Use use) {
    FanBoxes boxes(fan, tree);
    uint64_t version = version_;
    boxes.narrow(visible_.hull());
    boxes.skip(visible_.widest_gap());
    uint32_t* stack = stack_base;
    *stack++ = 0;
    while (stack != stack_base) {
      // Two nodes at a time: their tests overlap where one alone would wait for its loads. Without a second
      // one the first is tested twice, and the second result dropped.
      const bool pair = stack - stack_base > 1;
      const LineNode& node0 = tree.nodes[*--stack];
      const LineNode& node1 = tree.nodes[stack[pair ? -1 : 0]];
      stack -= pair;
      counters_.nodes_visited += 1 + pair;
      const uint32_t met0 = boxes.meeting(node0), met1 = pair ? boxes.meeting(node1) : 0;
      const int found = push(node0, met0, stack, leaves, 0);
      const int all = push(node1, met1, stack, leaves, found);
      if (all == 0) continue;
      use(leaves, all, stack, leaves + 2 * kWidth);
      if (version == version_) continue;
      if (visible_.empty()) return;
      version = version_;
      boxes.narrow(visible_.hull());
      boxes.skip(visible_.widest_gap());
    }
  }

  /// Inner nodes go on the stack, leaves behind the `found` ones; returns how many of these there are.
  static int push(const LineNode& node, uint32_t met, uint32_t*& stack, uint32_t* leaves, int found) {
    Simd::compress(stack, met & ~node.leaves, node.child);
    stack += std::popcount(met & ~node.leaves);
    Simd::compress(leaves + found, met & node.leaves, node.child);
    return found + std::popcount(met & node.leaves);
  }

  const LineBvh& bvh_;
  LineWorkspace& workspace_;
  QueryCounters& counters_;
  const LineQuery* query_ = nullptr;
  VisibleSet visible_;
  HiddenIntervals hidden_;
  uint64_t version_ = 0;  ///< of the visible set
  float widest_ = 0;      ///< what the best occluder of this query hides
  uint32_t occluder_ = 0;
  bool occluder_world_ = false;
};

void visible_vector(const LineBvh& bvh, std::span<const LineQuery> queries, std::vector<IntervalSet>& out,
                    QueryCounters& counters) {
  LineWalk walk(bvh, line_workspace(bvh.depth()), counters);
  for (size_t i = 0; i < queries.size(); ++i) walk.run(queries[i], out[i]);
}

}  // namespace
}  // namespace penumbra
