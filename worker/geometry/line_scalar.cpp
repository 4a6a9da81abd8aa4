// The reference walk: plain, scalar, one query at a time. Kept for good as the oracle of the vector paths.
#include <cmath>

#include "worker/geometry/line_query.h"
#include "worker/geometry/tube.h"

namespace penumbra {
namespace {

/// Can a box relative to the tree's centre meet the fan? Compares bounds only: the fan's own box, and the
/// two sides of its plane. Slack covers the rounding of what the triangles inside are decided by.
class BoxTest {
 public:
  BoxTest(const LineFan& fan, const LineTree& tree)
      : x_(fan.x_exact - tree.centre), g_(fan.g_exact), slack_(fan.slack) {
    for (int k = 0; k < 3; ++k) {
      lo_[k] = x_[k] + std::min({0., fan.a[k], fan.b[k]}) - slack_;
      hi_[k] = x_[k] + std::max({0., fan.a[k], fan.b[k]}) + slack_;
    }
  }
  bool may_meet(const LineNode& node, int lane) const {
    double g_lo = 0, g_hi = 0, size = 0;
    for (int k = 0; k < 3; ++k) {
      const double lo = node.lo[k][lane], hi = node.hi[k][lane];
      if (lo > hi_[k] || hi < lo_[k]) return false;
      g_lo += g_[k] * ((g_[k] > 0 ? lo : hi) - x_[k]);
      g_hi += g_[k] * ((g_[k] > 0 ? hi : lo) - x_[k]);
      size += std::abs(g_[k]);
    }
    return g_lo <= slack_ * size && g_hi >= -slack_ * size;
  }

 private:
  Vec3d x_, g_, lo_, hi_;
  double slack_;
};

class Walk {
 public:
  Walk(const LineBvh& bvh, const LineQuery& query, IntervalSet& visible, QueryCounters& counters)
      : bvh_(bvh), query_(query), visible_(visible), counters_(counters) {}

  void run() {
    const Vec3d x(query_.x), a = Vec3d(query_.a) - x, b = Vec3d(query_.b) - x;
    visible_.clear();
    if (make_fan(x, a, b, 0).degenerate) return;  // a chord seen end on has no width to be seen by
    visible_.reset();
    const LightPlane plane = chord_plane(query_);
    tree(bvh_.world, x, a, b, plane, excluded_in(bvh_, query_, kNone));
    if (!bvh_.tubes.tree.nodes.empty()) tubes(x, a, b);
    if (bvh_.instance_tree.nodes.empty()) return;
    const LineFan fan = make_fan(x, a, b, bvh_.instance_tree.reach(x), plane);
    leaves(bvh_.instance_tree, fan, [&](uint32_t instance) {
      const LineInstance& placed = bvh_.instances[instance];
      Vec3d ox, oa, ob;
      const Matrix& to_object = placed.to_object_at(query_.time);
      to_object.multVecMatrix(x, ox);
      to_object.multDirMatrix(a, oa);
      to_object.multDirMatrix(b, ob);
      tree(bvh_.objects[placed.tree], ox, oa, ob, placed_plane(plane, a, b, to_object),
           excluded_in(bvh_, query_, instance));
    });
  }

 private:
  void tubes(const Vec3d& x, const Vec3d& a, const Vec3d& b) {
    const TubeFan tube_fan(x, a, b);
    leaves(bvh_.tubes.tree, make_fan(x, a, b, bvh_.tubes.tree.reach(x)), [&](uint32_t segment) {
      const Interval hidden = hidden_by_tube(tube_fan, TubeSegment(bvh_.tubes.segments[segment]));
      visible_.subtract(hidden.lo, hidden.hi);
      ++counters_.triangles_tested;
    });
  }

  template <class UseLeaf>
  void leaves(const LineTree& tree, const LineFan& fan, UseLeaf use) {
    const BoxTest test(fan, tree);
    std::vector<uint32_t> stack{0};
    while (!stack.empty() && !visible_.empty()) {
      const LineNode& node = tree.nodes[stack.back()];
      stack.pop_back();
      ++counters_.nodes_visited;
      for (int lane = 0; lane < kWidth; ++lane) {
        if (!test.may_meet(node, lane)) continue;
        if (node.leaves >> lane & 1) {
          use(node.child[lane]);
        } else {
          stack.push_back(node.child[lane]);
        }
      }
    }
  }

  void tree(const LineTree& tree, const Vec3d& x, const Vec3d& a, const Vec3d& b, const LightPlane& plane,
            const Excluded& excluded) {
    if (tree.nodes.empty()) return;
    const LineFan fan = make_fan(x, a, b, tree.reach(x), plane);
    if (fan.degenerate) return;
    leaves(tree, fan, [&](uint32_t block_index) {
      tree.blocks[block_index].for_each_triangle([&](const std::array<Vec3f, 3>& p, uint32_t id) {
        if (excluded.holds(id)) return;
        const Interval hidden = hidden_by_triangle(fan, p.data());
        visible_.subtract(hidden.lo, hidden.hi);
      });
      counters_.triangles_tested += kTrianglesPerBlock;
    });
  }

  const LineBvh& bvh_;
  const LineQuery& query_;
  IntervalSet& visible_;
  QueryCounters& counters_;
};

}  // namespace

void visible_scalar(const LineBvh& bvh, std::span<const LineQuery> queries, std::vector<IntervalSet>& out,
                    QueryCounters& counters) {
  for (size_t i = 0; i < queries.size(); ++i) Walk(bvh, queries[i], out[i], counters).run();
}

}  // namespace penumbra
