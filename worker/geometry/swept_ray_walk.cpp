#include "worker/geometry/swept_ray_walk.h"

#include <algorithm>
#include <cmath>

#include "worker/geometry/bow_tie_walk.h"
#include "worker/geometry/lower_envelope.h"
#include "worker/geometry/swept_ray.h"

namespace penumbra {
namespace {

/// Radians that a ray may turn, seen from an object, in one step that is taken for linear: it is then off by
/// 1/8 of this squared, 2e-3, of its distance from what it turns about.
constexpr double kLargestTurn = 1.0 / 8;
/// A motion that winds more than this many steps serves nobody.
constexpr int kMostSteps = 64;

/// Something to visit, no nearer than `distance`, during a part of the step.
struct Visit {
  double distance, lo, hi;
  uint32_t child;
  bool leaf;
};

class TimeWalk {
 public:
  TimeWalk(const LineBvh& bvh, const RayInTime& ray, LowerEnvelope& envelope, QueryCounters& counters)
      : bvh_(bvh), ray_(ray), envelope_(envelope), counters_(counters) {}

  void run() {
    find_instances();
    // What moves, seen from the ray, first: where none of it is met, there is nothing to tell apart.
    for (const uint32_t number : instances_)
      if (moves(number)) object(number);
    const LowerEnvelope::Item& first = envelope_.items().front();
    if (ray_.camera == nullptr && first.label == kNothingThere && first.hi == 1) return;
    for (const uint32_t number : instances_)
      if (!moves(number)) object(number);
    in_steps(nullptr, [&](const SweptRay& swept) { triangles(bvh_.world, swept, kNone); });
  }

 private:
  bool moves(uint32_t number) const {
    return ray_.camera != nullptr || bvh_.instances[number].motion != nullptr;
  }

  void find_instances() {
    instances_.clear();
    if (bvh_.instance_tree.nodes.empty()) return;
    in_steps(nullptr, [&](const SweptRay& swept) {
      walk(bvh_.instance_tree, swept, [&](uint32_t number) { instances_.push_back(number); });
    });
    // Each step finds its own.
    std::sort(instances_.begin(), instances_.end());
    instances_.erase(std::unique(instances_.begin(), instances_.end()), instances_.end());
  }

  void object(uint32_t number) {
    const LineInstance& placed = bvh_.instances[number];
    in_steps(&placed, [&](const SweptRay& swept) { triangles(bvh_.objects[placed.tree], swept, number); });
  }

  /// The ray in steps, as it is in the space of an instance, or in the world.
  template <class Use>
  void in_steps(const LineInstance* placed, Use use) {
    const AnimatedTransform* const motion = placed ? placed->motion.get() : nullptr;
    times_.clear();
    double turn = 0;
    for (const AnimatedTransform* moving : {ray_.camera, motion}) {
      if (moving == nullptr) continue;
      turn += moving->turn();
      moving->add_ends(times_);
    }
    const int steps = static_cast<int>(std::clamp(std::ceil(turn / kLargestTurn), 1.0, double{kMostSteps}));
    for (int i = 0; i <= steps; ++i) times_.push_back(double(i) / steps);
    std::sort(times_.begin(), times_.end());
    SweptRay swept;
    at(placed, 0, swept.origin[1], swept.direction[1]);
    for (size_t i = 1; i < times_.size(); ++i) {
      from_ = times_[i - 1], until_ = times_[i];
      if (!(from_ < until_)) continue;
      swept.origin[0] = swept.origin[1], swept.direction[0] = swept.direction[1];
      at(placed, until_, swept.origin[1], swept.direction[1]);
      use(swept);
    }
  }

  void at(const LineInstance* placed, double time, Vec3d& origin, Vec3d& direction) const {
    origin = ray_.origin, direction = ray_.direction;
    const auto carry = [&](const Matrix& m) {
      m.multVecMatrix(Vec3d(origin), origin);
      m.multDirMatrix(Vec3d(direction), direction);
    };
    if (ray_.camera != nullptr) {
      carry(ray_.to_camera);
      carry(ray_.camera->at(time));
    }
    if (placed != nullptr) carry(placed->to_object_at(static_cast<float>(time)));
  }

  double time_of(double s) const { return from_ + (until_ - from_) * s; }

  void triangles(const LineTree& tree, const SweptRay& swept, uint32_t instance) {
    if (tree.nodes.empty()) return;
    walk(tree, swept, [&](uint32_t block) { test(tree.blocks[block], swept, instance); });
  }

  void test(const PairBlock& block, const SweptRay& swept, uint32_t instance) {
    counters_.triangles_tested += kTrianglesPerBlock;
    block.for_each_triangle([&](const std::array<Vec3f, 3>& p, uint32_t id) {
      TimeCover covers[kMostCovers];
      for (int n = covers_of_triangle(swept, p.data(), covers); n > 0; --n) {
        // The envelope's 1/k is the distance; between two times it is taken for linear, which it is for what
        // does not turn.
        const TimeCover& cover = covers[n - 1];
        CutPiece piece;
        piece.lo = time_of(cover.lo), piece.hi = time_of(cover.hi);
        if (!(piece.lo < piece.hi)) continue;
        piece.slope = (cover.at_hi - cover.at_lo) / (piece.hi - piece.lo);
        piece.start = cover.at_lo - piece.slope * piece.lo;
        if (std::isfinite(piece.slope) && std::isfinite(piece.start)) envelope_.insert(piece, {instance, id});
      }
    });
  }

  /// Leaves that the ray may meet before what is known, from near to far within each node.
  template <class UseLeaf>
  void walk(const LineTree& tree, const SweptRay& swept, UseLeaf use) {
    const SweptBoxes boxes(swept, tree);
    std::vector<Visit>& stack = stack_;
    stack.clear();
    stack.push_back({0, 0, 1, 0, false});
    while (!stack.empty()) {
      const Visit visit = stack.back();
      stack.pop_back();
      if (envelope_.nearer_than(1 / visit.distance, time_of(visit.lo), time_of(visit.hi))) continue;
      if (visit.leaf)
        use(visit.child);
      else
        push(boxes, tree.nodes[visit.child], stack);
    }
  }

  void push(const SweptBoxes& boxes, const LineNode& node, std::vector<Visit>& stack) {
    ++counters_.nodes_visited;
    SweptBoxes::Met met;
    boxes.test(node, met);
    const size_t first = stack.size();
    for (int lane = 0; lane < kWidth; ++lane)
      if (met.met[lane])
        stack.push_back({met.distance[lane], met.lo[lane], met.hi[lane], node.child[lane],
                         (node.leaves >> lane & 1) != 0});
    std::sort(stack.begin() + static_cast<ptrdiff_t>(first), stack.end(),
              [](const Visit& a, const Visit& b) { return a.distance > b.distance; });
  }

  const LineBvh& bvh_;
  const RayInTime& ray_;
  LowerEnvelope& envelope_;
  QueryCounters& counters_;
  double from_ = 0, until_ = 1;  ///< of the step
  std::vector<double> times_;
  std::vector<uint32_t> instances_;
  std::vector<Visit> stack_;
};

}  // namespace

void nearest_in_time(const LineBvh& bvh, const RayInTime& ray, std::vector<SeenInterval>& out,
                     QueryCounters& counters) {
  ++counters.line_queries;
  thread_local LowerEnvelope envelope;
  envelope.reset();
  TimeWalk(bvh, ray, envelope, counters).run();
  seen_of(bvh, envelope, out);
}

}  // namespace penumbra
