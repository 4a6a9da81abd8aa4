#pragma once
// The walk of a shaft through the hierarchy, sixteen boxes or triangles at a time. Included by one file per
// instruction set.
#include <array>
#include <bit>
#include <limits>

#include "worker/geometry/fan_block.h"
#include "worker/geometry/line_workspace.h"
#include "worker/geometry/shaft_list.h"
#include "worker/geometry/visible_set.h"

namespace penumbra {
namespace {

/// Which of a node's boxes can meet the pyramid: none of its faces has the whole box outside, and the bounds
/// overlap.
class ShaftBoxes {
  using S = Simd;

 public:
  ShaftBoxes(const ShaftPlanes& planes, const LineTree& tree) : count_(planes.face_count) {
    const Vec3f x(planes.x_exact - tree.centre);
    for (int f = 0; f < count_; ++f) {
      const ShaftFace& face = planes.faces[f];
      faces_[f].d = face.offset - (face.normal ^ x);
      for (int k = 0; k < 3; ++k) {
        faces_[f].n[k] = face.normal[k];
        faces_[f].row[k] = face.normal[k] > 0 ? 3 + k : k;  // the corner farthest inside
      }
    }
    for (int k = 0; k < 3; ++k) lo_[k] = x[k] + planes.lo[k], hi_[k] = x[k] + planes.hi[k];
  }

  uint32_t meeting(const LineNode& node) const {
    const float(*rows)[kWidth] = node.lo;
    S::Mask met = S::both(S::less_equal(S::load(rows[0]), S::all(hi_[0])),
                          S::less_equal(S::all(lo_[0]), S::load(rows[3])));
    for (int k = 1; k < 3; ++k) {
      met = S::both(met, S::both(S::less_equal(S::load(rows[k]), S::all(hi_[k])),
                                 S::less_equal(S::all(lo_[k]), S::load(rows[3 + k]))));
    }
    S::Floats least = faces_[0].at(rows);
    for (int f = 1; f < count_; ++f) least = S::min(least, faces_[f].at(rows));
    return S::bits(S::both(met, S::less_equal(S::all(0), least)));
  }

 private:
  struct Face {
    float n[3], d;
    int row[3];
    S::Floats at(const float (*rows)[kWidth]) const {
      S::Floats v = S::fma(S::all(n[0]), S::load(rows[row[0]]), S::all(d));
      v = S::fma(S::all(n[1]), S::load(rows[row[1]]), v);
      return S::fma(S::all(n[2]), S::load(rows[row[2]]), v);
    }
  };
  int count_;
  Face faces_[ShaftPlanes::kMostFaces];
  float lo_[3], hi_[3];
};

/// Sixteen pairs of triangles against the pyramid.
class ShaftBlock {
  using S = Simd;

 public:
  ShaftBlock(const ShaftPlanes& planes, const PairBlock& block) : planes_(planes) {
    for (int c = 0; c < 4; ++c)
      for (int k = 0; k < 3; ++k) q_[c][k] = S::sub(S::load(block.p[c][k]), S::all(planes.x[k]));
  }

  /// Lanes whose first triangle, and whose second one, no face of the pyramid has wholly outside.
  std::array<uint32_t, 2> entering() const {
    S::Floats least[2] = {S::all(std::numeric_limits<float>::infinity()),
                          S::all(std::numeric_limits<float>::infinity())};
    for (int f = 0; f < planes_.face_count; ++f) {
      const ShaftFace& face = planes_.faces[f];
      const S::Floats shared = S::max(at(face, 0), at(face, 1));
      for (int i = 0; i < 2; ++i) least[i] = S::min(least[i], S::max(shared, at(face, 2 + i)));
    }
    return {S::bits(S::less_equal(S::all(0), least[0])), S::bits(S::less_equal(S::all(0), least[1]))};
  }

  /// Lanes in which a triangle's plane seems to have all of the light on one side: worth a look in double
  /// precision.
  uint32_t light_aside(int which) const {
    S::Floats e1[3], e2[3], n[3];
    const S::Floats* own = q_[2 + which];
    for (int k = 0; k < 3; ++k) e1[k] = S::sub(q_[1][k], q_[0][k]), e2[k] = S::sub(own[k], q_[0][k]);
    for (int k = 0; k < 3; ++k) n[k] = minor(e1, e2, (k + 1) % 3, (k + 2) % 3);
    const S::Floats plane = S::fma(n[2], q_[0][2], S::fma(n[1], q_[0][1], S::mul(n[0], q_[0][0])));
    S::Floats lowest = plane, highest = plane;
    for (int i = 0; i < 4; ++i) {
      const Vec3f& a = planes_.corners_single[i];
      const S::Floats at = S::fma(n[2], S::all(a.z), S::fma(n[1], S::all(a.y), S::mul(n[0], S::all(a.x))));
      lowest = i == 0 ? at : S::min(lowest, at);
      highest = i == 0 ? at : S::max(highest, at);
    }
    return S::bits(S::either(S::less(plane, lowest), S::less(highest, plane)));
  }

  /// Lanes in which a triangle seems to lie before the middle of the light.
  uint32_t before_middle(int which) const {
    S::Mask positive = S::mask(0xffff), negative = positive;
    const S::Floats d[3] = {S::all(planes_.middle.x), S::all(planes_.middle.y), S::all(planes_.middle.z)};
    const S::Floats* corners[3] = {q_[0], q_[1], q_[2 + which]};
    for (int c = 0; c < 3; ++c) {
      // (middle × a)·b: the sides' own normals are not needed.
      const S::Floats *a = corners[c], *b = corners[(c + 1) % 3];
      S::Floats side = S::mul(minor(d, a, 1, 2), b[0]);
      side = S::fma(minor(d, a, 2, 0), b[1], side);
      side = S::fma(minor(d, a, 0, 1), b[2], side);
      positive = S::both(positive, S::less(S::all(0), side));
      negative = S::both(negative, S::less(side, S::all(0)));
    }
    return S::bits(S::either(positive, negative));
  }

 private:
  static S::Floats minor(const S::Floats* a, const S::Floats* b, int i, int j) {
    return S::sub(S::mul(a[i], b[j]), S::mul(a[j], b[i]));
  }
  S::Floats at(const ShaftFace& face, int c) const {
    S::Floats v = S::fma(S::all(face.normal.x), q_[c][0], S::all(face.offset));
    v = S::fma(S::all(face.normal.y), q_[c][1], v);
    return S::fma(S::all(face.normal.z), q_[c][2], v);
  }

  const ShaftPlanes& planes_;
  S::Floats q_[4][3];
};

class ShaftWalk {
 public:
  ShaftWalk(const LineBvh& bvh, const Excluded& excluded, Shaft::Parts& shaft, QueryCounters& counters)
      : bvh_(bvh), excluded_(excluded), shaft_(shaft), counters_(counters) {}

  ShaftContent run() {
    LineWorkspace& workspace = line_workspace(bvh_.depth());
    // Placed objects are not looked into: where one may stand in the way, lines are asked singly.
    if (!bvh_.instance_tree.nodes.empty()) {
      find_leaves(bvh_.instance_tree, workspace.lines[0].stack.data());
      if (leaf_count_ != 0) return ShaftContent::kMany;
    }
    // Nor are tubes.
    if (!bvh_.tubes.tree.nodes.empty()) {
      find_leaves(bvh_.tubes.tree, workspace.lines[0].stack.data());
      if (leaf_count_ != 0) return ShaftContent::kMany;
    }
    find_leaves(bvh_.world, workspace.lines[0].stack.data());
    if (leaf_count_ > kMostLeaves) return ShaftContent::kMany;
    for (int i = 0; i < leaf_count_; ++i) {
      if (block_enters(leaves_[i])) continue;
      return covered_ ? ShaftContent::kHidden : ShaftContent::kMany;
    }
    shaft_.list.finish();
    return shaft_.list.size() == 0 ? ShaftContent::kClear : ShaftContent::kFew;
  }

 private:
  /// With more leaves than these the list would overflow, mostly.
  static constexpr int kMostLeaves = 16;

  /// Finds the leaves that the shaft meets, until they are too many.
  void find_leaves(const LineTree& tree, uint32_t* stack_base) {
    const ShaftBoxes boxes(shaft_.planes, tree);
    leaf_count_ = 0;
    uint32_t* stack = stack_base;
    *stack++ = 0;
    while (stack != stack_base && leaf_count_ <= kMostLeaves) {
      const LineNode& node = tree.nodes[*--stack];
      ++counters_.nodes_visited;
      const uint32_t met = boxes.meeting(node), inner = met & ~node.leaves;
      Simd::compress(stack, inner, node.child);
      stack += std::popcount(inner);
      Simd::compress(leaves_ + leaf_count_, met & node.leaves, node.child);
      leaf_count_ += std::popcount(met & node.leaves);
    }
  }

  /// Lists what of a block can hide some of the light. False: that is settled, or too much.
  bool block_enters(uint32_t index) {
    counters_.triangles_tested += kTrianglesPerBlock;
    const ShaftBlock test(shaft_.planes, bvh_.world.blocks[index]);
    std::array<uint32_t, 2> lanes = test.entering();
    for (int which = 0; which < 2; ++which) {
      lanes[which] = in_the_way(index, which, lanes[which], test);
      if (lanes[which] == 0) continue;
      const uint32_t middle = test.before_middle(which) & lanes[which];
      if (middle != 0 && covered(index, which, middle)) return false;
    }
    if (shaft_.list.size() + std::popcount(lanes[0]) + std::popcount(lanes[1]) > ShaftList::kMost)
      return false;
    for (uint32_t left = lanes[0] | lanes[1]; left != 0; left &= left - 1) {
      const int lane = std::countr_zero(left);
      shaft_.list.add(bvh_.world.blocks[index], lane, lanes[0] >> lane & 1, lanes[1] >> lane & 1);
    }
    return true;
  }

  /// Of the lanes whose triangle enters, those that may hide some of the light.
  uint32_t in_the_way(uint32_t index, int which, uint32_t lanes, const ShaftBlock& test) const {
    if (lanes == 0) return 0;
    const PairBlock& block = bvh_.world.blocks[index];
    if (excluded_.count != 0)
      lanes &= ~Simd::bits(Simd::in_range(block.id[which], excluded_.first, excluded_.count));
    lanes &= ~Simd::bits(Simd::in_range(block.id[which], kNone, 1));
    if (lanes == 0) return 0;
    for (uint32_t aside = lanes & test.light_aside(which); aside != 0; aside &= aside - 1) {
      const int lane = std::countr_zero(aside);
      if (shaft_.planes.plane_clears(block.triangle(lane, which).data())) lanes &= ~(1u << lane);
    }
    return lanes;
  }

  bool covered(uint32_t index, int which, uint32_t lanes) {
    const PairBlock& block = bvh_.world.blocks[index];
    for (; lanes != 0; lanes &= lanes - 1) {
      const int lane = std::countr_zero(lanes);
      if (!shaft_.planes.covered_by(block.triangle(lane, which).data())) continue;
      shaft_.cover_bvh = bvh_.id;
      shaft_.cover_block = index;
      shaft_.cover_lane = lane;
      shaft_.cover_which = which;
      return covered_ = true;
    }
    return false;
  }

  const LineBvh& bvh_;
  const Excluded excluded_;
  Shaft::Parts& shaft_;
  QueryCounters& counters_;
  bool covered_ = false;
  int leaf_count_ = 0;
  uint32_t leaves_[kMostLeaves + 2 * kWidth];  ///< a whole vector may be written past the last one
};

/// Lines against a list alone: the same fans, in the world's coordinates, as a walk of the whole makes.
class ListLines {
 public:
  ListLines(const LineBvh& bvh, const ShaftList& list, QueryCounters& counters)
      : bvh_(bvh), list_(list), counters_(counters), buffers_(line_workspace(bvh.depth()).lines[0]) {}

  void run(const LineQuery& query, IntervalSet& out) {
    out.clear();
    const Vec3d x(query.x);
    const LineFan fan =
        make_fan(x, Vec3d(query.a) - x, Vec3d(query.b) - x, bvh_.world.reach(x), chord_plane(query));
    if (fan.degenerate) return;
    visible_.reset(buffers_);
    FanBlock fan_block;
    fan_block.set_up(fan);
    for (const PairBlock& block : list_.blocks()) {
      const Interval hull = visible_.hull();
      float widest = 0;
      // The list leaves out the light's own triangles.
      fan_block.hidden(block, {}, hull.lo, hull.hi, hidden_, widest);
      counters_.triangles_tested += kTrianglesPerBlock;
      fan_block.settle(hidden_, hull.lo, hull.hi);
      if (!hidden_.empty()) hidden_.flush(visible_);
      if (visible_.empty()) return;
    }
    visible_.append_to(out);
  }

 private:
  const LineBvh& bvh_;
  const ShaftList& list_;
  QueryCounters& counters_;
  LineBuffers& buffers_;
  VisibleSet visible_;
  HiddenIntervals hidden_;
};

ShaftContent walk_shaft(const LineBvh& bvh, const Excluded& excluded, Shaft::Parts& shaft,
                        QueryCounters& counters) {
  return ShaftWalk(bvh, excluded, shaft, counters).run();
}

void list_lines(const LineBvh& bvh, const ShaftList& list, std::span<const LineQuery> queries,
                std::vector<IntervalSet>& out, QueryCounters& counters) {
  ListLines lines(bvh, list, counters);
  for (size_t i = 0; i < queries.size(); ++i) lines.run(queries[i], out[i]);
}

}  // namespace
}  // namespace penumbra
