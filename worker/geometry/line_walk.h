#pragma once
// The walk of line queries through the hierarchy, sixteen boxes or triangles at a time. Included by one file
// per instruction set.
//
// The lines of one call take turns, a step each: while the others work, memory fetches what the next step
// needs. No line sees anything of another one but the guess which block to try first.
#include "worker/geometry/fan_block.h"
#include "worker/geometry/fan_boxes.h"
#include "worker/geometry/line_query.h"
#include "worker/geometry/tube.h"
#include "worker/geometry/visible_set.h"

namespace penumbra {
namespace {

template <class T>
void prefetch(const T& object) {
  for (size_t at = 0; at < sizeof(T); at += 64)
    _mm_prefetch(reinterpret_cast<const char*>(&object) + at, _MM_HINT_T0);
}

/// What lines of one call share: memory that no line needs from one step to the next.
struct WalkContext {
  WalkContext(const LineBvh& b, QueryCounters& c)
      : bvh(b), workspace(line_workspace(b.depth())), counters(c) {}
  const LineBvh& bvh;
  LineWorkspace& workspace;
  QueryCounters& counters;
  HiddenIntervals hidden;
};

/// A line's way through one tree: two nodes at a time, narrowed to what is still visible.
class TreeWalk {
 public:
  void start(const LineTree& tree, const LineFan& fan, const VisibleSet& visible, uint32_t* stack) {
    tree_ = &tree;
    boxes_.set_up(fan, tree);
    base_ = stack_ = stack;
    *stack_++ = 0;
    narrow(visible);
  }

  void narrow(const VisibleSet& visible) {
    boxes_.narrow(visible.hull());
    boxes_.skip(visible.widest_gap());
  }
  bool done() const { return stack_ == base_; }
  uint32_t* free_stack() const { return stack_; }

  /// Visits nodes; returns how many leaves they add.
  int step(uint32_t* leaves, QueryCounters& counters) {
    // Two nodes at a time: their tests overlap where one alone would wait for its loads. Without a second
    // one the first is tested twice, and the second result dropped.
    const bool pair = stack_ - base_ > 1;
    const LineNode& node0 = tree_->nodes[*--stack_];
    const LineNode& node1 = tree_->nodes[stack_[pair ? -1 : 0]];
    stack_ -= pair;
    counters.nodes_visited += 1 + pair;
    const uint32_t met0 = boxes_.meeting(node0), met1 = pair ? boxes_.meeting(node1) : 0;
    const int found = push(node0, met0, leaves, 0);
    return push(node1, met1, leaves, found);
  }

  /// Asks memory for the nodes of the next step.
  void prefetch_nodes() const {
    if (stack_ - base_ > 0) prefetch(tree_->nodes[stack_[-1]]);
    if (stack_ - base_ > 1) prefetch(tree_->nodes[stack_[-2]]);
  }

 private:
  /// Inner nodes go on the stack, leaves behind the `found` ones; returns how many of these there are.
  int push(const LineNode& node, uint32_t met, uint32_t* leaves, int found) {
    Simd::compress(stack_, met & ~node.leaves, node.child);
    stack_ += std::popcount(met & ~node.leaves);
    Simd::compress(leaves + found, met & node.leaves, node.child);
    return found + std::popcount(met & node.leaves);
  }

  const LineTree* tree_;
  FanBoxes boxes_;
  uint32_t *base_, *stack_;
};

/// One line on its way.
class LineWalk {
 public:
  void start(WalkContext& context, LineBuffers& buffers, const LineQuery& query) {
    context_ = &context;
    buffers_ = &buffers;
    query_ = &query;
    visible_.reset(buffers);
    found_ = 0;
    widest_ = 0;
    walking_ = false;
    const LineTree& frame = bvh().world.nodes.empty() ? bvh().instance_tree : bvh().world;
    x_ = Vec3d(query.x), a_ = Vec3d(query.a) - x_, b_ = Vec3d(query.b) - x_;
    plane_ = chord_plane(query);
    penumbra::set_up(fan_, x_, a_, b_, frame.nodes.empty() ? 0 : frame.reach(x_), plane_);
    in_world_ = !fan_.degenerate && !bvh().world.nodes.empty();
    if (!in_world_) return;
    excluded_ = excluded_in(bvh(), query, kNone);
    block_.set_up(fan_);
    if (context.workspace.occluder_tree != bvh().id) return;
    buffers.leaves[0] = context.workspace.occluder;
    found_ = 1;
  }

  /// A step through the world: the leaves found last, then the next nodes. False: that was all.
  bool step() {
    if (!in_world_) return false;
    if (found_ != 0 && test(block_, bvh().world, buffers_->leaves.data(), found_, excluded_)) {
      if (visible_.empty()) return false;
      if (walking_) walk_.narrow(visible_);
    }
    if (!walking_) walk_.start(bvh().world, fan_, visible_, buffers_->stack.data());
    walking_ = true;
    if (walk_.done()) return false;
    found_ = walk_.step(buffers_->leaves.data(), context_->counters);
    return true;
  }

  /// Asks memory for what the next step needs.
  void prefetch_next() const {
    for (int i = 0; i < found_; ++i) prefetch(bvh().world.blocks[buffers_->leaves[i]]);
    walk_.prefetch_nodes();
  }

  /// After the last step.
  void finish(IntervalSet& out) {
    out.clear();
    if (fan_.degenerate) return;  // a chord seen end on has no width to be seen by
    if (!bvh().tubes.tree.nodes.empty() && !visible_.empty()) tubes();
    if (!bvh().instance_tree.nodes.empty() && !visible_.empty()) placed_objects();
    // A neighbour of a lit point is mostly lit: then there is nothing to try first.
    context_->workspace.occluder_tree = widest_ > 0 && occluder_world_ ? bvh().id : 0;
    context_->workspace.occluder = occluder_;
    visible_.append_to(out);
  }

 private:
  const LineBvh& bvh() const { return context_->bvh; }

  void tubes() {
    const LineTubes& tubes = bvh().tubes;
    const LineFan fan = make_fan(x_, a_, b_, tubes.tree.reach(x_));
    const TubeFan tube_fan(x_, a_, b_);
    TreeWalk walk;
    walk.start(tubes.tree, fan, visible_, buffers_->stack.data());
    while (!walk.done()) {
      const int found = walk.step(buffers_->leaves.data(), context_->counters);
      context_->counters.triangles_tested += static_cast<uint64_t>(found);
      bool changed = false;
      for (int i = 0; i < found; ++i) {
        const Interval hidden = hidden_by_tube(tube_fan, TubeSegment(tubes.segments[buffers_->leaves[i]]));
        if (!(hidden.lo < hidden.hi)) continue;
        changed |= visible_.subtract(hidden.lo, hidden.hi);
        if (visible_.empty()) return;
      }
      if (changed) walk.narrow(visible_);
    }
  }

  void placed_objects() {
    const LineFan fan = make_fan(x_, a_, b_, bvh().instance_tree.reach(x_), plane_);
    TreeWalk walk;
    walk.start(bvh().instance_tree, fan, visible_, buffers_->stack.data());
    while (!walk.done()) {
      const int found = walk.step(buffers_->leaves.data(), context_->counters);
      bool changed = false;
      for (int i = 0; i < found; ++i) {
        changed |=
            placed_object(buffers_->leaves[i], walk.free_stack(), buffers_->leaves.data() + 2 * kWidth);
        if (visible_.empty()) return;
      }
      if (changed) walk.narrow(visible_);
    }
  }

  bool placed_object(uint32_t instance, uint32_t* stack, uint32_t* leaves) {
    const LineInstance& placed = bvh().instances[instance];
    const LineTree& tree = bvh().objects[placed.tree];
    Vec3d x, a, b;
    const Matrix& to_object = placed.to_object_at(query_->time);
    to_object.multVecMatrix(x_, x);
    to_object.multDirMatrix(a_, a);
    to_object.multDirMatrix(b_, b);
    const LineFan fan = make_fan(x, a, b, tree.reach(x), placed_plane(plane_, a_, b_, to_object));
    if (fan.degenerate) return false;
    FanBlock fan_block;
    fan_block.set_up(fan);
    const Excluded excluded = excluded_in(bvh(), *query_, instance);
    TreeWalk walk;
    walk.start(tree, fan, visible_, stack);
    bool changed = false;
    while (!walk.done()) {
      const int found = walk.step(leaves, context_->counters);
      if (found == 0 || !test(fan_block, tree, leaves, found, excluded)) continue;
      changed = true;
      if (visible_.empty()) return true;
      walk.narrow(visible_);
    }
    return changed;
  }

  /// Takes from the visible set what some blocks hide of it. True if that changed it.
  bool test(const FanBlock& fan_block, const LineTree& tree, const uint32_t* blocks, int count,
            const Excluded& excluded) {
    const Interval hull = visible_.hull();
    HiddenIntervals& hidden = context_->hidden;
    const bool large = tree.nodes.size() == 1;  // a few triangles that make up a room
    for (int i = 0; i < count; ++i) {
      const PairBlock& block = tree.blocks[blocks[i]];
      if (large ? fan_block.hidden_by_large(block, excluded, hull.lo, hull.hi, hidden, widest_)
                : fan_block.hidden(block, excluded, hull.lo, hull.hi, hidden, widest_)) {
        occluder_ = blocks[i];
        occluder_world_ = &tree == &bvh().world;
      }
    }
    context_->counters.triangles_tested += static_cast<uint64_t>(kTrianglesPerBlock * count);
    fan_block.settle(hidden, hull.lo, hull.hi);
    return !hidden.empty() && hidden.flush(visible_);
  }

  WalkContext* context_;
  LineBuffers* buffers_;
  const LineQuery* query_;
  VisibleSet visible_;
  Vec3d x_, a_, b_;
  LightPlane plane_;  ///< of the chord
  LineFan fan_;       ///< in the world, as are the next three
  Excluded excluded_;
  FanBlock block_;
  TreeWalk walk_;
  bool in_world_, walking_;  ///< the world has something to meet; the walk has begun
  int found_;                ///< leaves to test in the next step
  float widest_;             ///< what the best occluder of this query hides
  uint32_t occluder_ = 0;
  bool occluder_world_ = false;
};

void visible_vector(const LineBvh& bvh, std::span<const LineQuery> queries, std::vector<IntervalSet>& out,
                    QueryCounters& counters) {
  constexpr size_t kTogether = LineWorkspace::kTogether;
  WalkContext context(bvh, counters);
  LineWalk lines[kTogether];
  const bool fetch = bvh.world.nodes.size() > 1;
  for (size_t first = 0; first < queries.size(); first += kTogether) {
    const size_t count = std::min(kTogether, queries.size() - first);
    uint32_t going = (1u << count) - 1;
    for (size_t i = 0; i < count; ++i)
      lines[i].start(context, context.workspace.lines[i], queries[first + i]);
    while (going != 0) {
      for (uint32_t left = going; left != 0; left &= left - 1) {
        const auto i = static_cast<uint32_t>(std::countr_zero(left));
        if (lines[i].step()) {
          if (fetch) lines[i].prefetch_next();
          continue;
        }
        lines[i].finish(out[first + i]);
        going &= ~(1u << i);
      }
    }
  }
}

}  // namespace
}  // namespace penumbra
