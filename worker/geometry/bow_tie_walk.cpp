#include "worker/geometry/bow_tie_walk.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "worker/geometry/bow_tie.h"
#include "worker/geometry/lower_envelope.h"
#include "worker/geometry/tube.h"

namespace penumbra {
namespace {

struct Range {
  double lo, hi;
};

/// A linear functional over sixteen boxes.
struct Ranges {
  double lo[kWidth], hi[kWidth];

  Ranges(const Vec3d& functional, const Vec3d& focus, const LineNode& node) {
    const double at_centre = -functional.dot(focus);  // `focus`: relative to the tree's centre, as boxes are
    for (int lane = 0; lane < kWidth; ++lane) lo[lane] = hi[lane] = at_centre;
    for (int axis = 0; axis < 3; ++axis) {
      const double c = functional[axis], size = std::abs(c);
      for (int lane = 0; lane < kWidth; ++lane) {
        const double middle = 0.5 * (double{node.lo[axis][lane]} + node.hi[axis][lane]);
        const double extent = 0.5 * (double{node.hi[axis][lane]} - node.lo[axis][lane]);
        lo[lane] += c * middle - size * extent;
        hi[lane] += c * middle + size * extent;
      }
    }
  }
};

/// Values of v = r/k that a box can have; all if it reaches to the focus's height.
Range chord_range(double r_lo, double r_hi, double k_lo, double k_hi) {
  if (k_hi < 0) return chord_range(-r_hi, -r_lo, -k_hi, -k_lo);
  if (!(k_lo > 0)) return {0, 1};
  return {r_lo / (r_lo > 0 ? k_hi : k_lo), r_hi / (r_hi > 0 ? k_lo : k_hi)};
}

/// Labels of tubes' segments have this in the instance's place.
constexpr uint32_t kTubeLabel = kNone - 1;

/// Something to visit, no nearer than depth k, over a part of the chord.
struct Visit {
  double k;
  Range chord;
  uint32_t child;
  bool leaf;
};

class BowTieWalk {
 public:
  BowTieWalk(const LineBvh& bvh, LowerEnvelope& envelope, QueryCounters& counters)
      : bvh_(bvh), envelope_(envelope), counters_(counters) {}

  void run(const FocusedChord& chord) {
    const auto& [a, b, focus, time, from_focus] = chord;
    from_focus_ = from_focus;
    const BowTie tie = bow_tie(a, b, focus);
    triangles(bvh_.world, tie, kNone);
    if (from_focus && !bvh_.tubes.tree.nodes.empty()) tubes(chord, tie);
    if (bvh_.instance_tree.nodes.empty()) return;
    walk(bvh_.instance_tree, tie, [&](uint32_t number) {
      // v and k are the same in every affine frame.
      const LineInstance& placed = bvh_.instances[number];
      Vec3d oa, ob, of;
      const Matrix& to_object = placed.to_object_at(chord.time);
      to_object.multVecMatrix(chord.a, oa);
      to_object.multVecMatrix(chord.b, ob);
      to_object.multVecMatrix(chord.focus, of);
      triangles(bvh_.objects[placed.tree], bow_tie(oa, ob, of), number);
    });
  }

 private:
  BowTie bow_tie(const Vec3d& a, const Vec3d& b, const Vec3d& focus) const {
    BowTie tie = make_bow_tie(a, b, focus);
    tie.from_focus = from_focus_;
    return tie;
  }

  /// What a segment covers is known as of a fan that reaches past all of them; how deep it lies, between its
  /// ends, as if it were straight in (v, 1/k).
  void tubes(const FocusedChord& chord, const BowTie& tie) {
    const Vec3d to_a = chord.focus - chord.a, to_b = chord.focus - chord.b;
    // The fan's rays are no shorter than the distance of the chord's line, which the shorter of the two is
    // next to for anything as narrow as a pixel; four times that reach for the rest.
    const double nearest = std::min(to_a.length(), to_b.length());
    const double far = 4 * bvh_.tubes.tree.reach(chord.focus) / nearest;
    const TubeFan fan(chord.focus, to_a * far, to_b * far);
    walk(bvh_.tubes.tree, tie, [&](uint32_t number) {
      ++counters_.triangles_tested;
      const TubeSegment segment(bvh_.tubes.segments[number]);
      const Interval covered = hidden_by_tube(fan, segment);
      if (!(covered.lo < covered.hi)) return;
      const auto inverse_depth = [&](double v) {
        const Vec3d d = to_a + v * (to_b - to_a), from = segment.c - chord.focus;
        // The axis' point nearest to the ray's line.
        const Vec3d across = segment.e - d * (segment.e.dot(d) / d.length2());
        const Vec3d off = from - d * (from.dot(d) / d.length2());
        const double w = across.length2() > 0 ? std::clamp(-off.dot(across) / across.length2(), 0., 1.) : 0;
        const double t = (from + w * segment.e).dot(d) / d.length2();
        return t > 0 ? -1 / t : -std::numeric_limits<double>::max();
      };
      const double lo = covered.lo, hi = covered.hi, at_lo = inverse_depth(lo), at_hi = inverse_depth(hi);
      const double slope = (at_hi - at_lo) / (hi - lo);
      if (std::isfinite(slope))
        envelope_.insert({lo, hi, at_lo - slope * lo, slope, true}, {kTubeLabel, number});
    });
  }

  void triangles(const LineTree& tree, const BowTie& tie, uint32_t instance) {
    if (tree.nodes.empty()) return;
    walk(tree, tie, [&](uint32_t block) { test(tree.blocks[block], tie, instance); });
  }

  void test(const PairBlock& block, const BowTie& tie, uint32_t instance) {
    counters_.triangles_tested += kTrianglesPerBlock;
    block.for_each_triangle([&](const std::array<Vec3f, 3>& p, uint32_t id) {
      CutPiece pieces[2];
      for (int n = cut_by_triangle(tie, p.data(), pieces); n > 0; --n)
        envelope_.insert(pieces[n - 1], {instance, id});
    });
  }

  /// Leaves that the bow-tie may meet before what is known, from near to far within each node.
  template <class UseLeaf>
  void walk(const LineTree& tree, const BowTie& tie, UseLeaf use) {
    if (tie.degenerate) return;
    std::vector<Visit> stack;
    stack.push_back({tie.from_focus ? 0. : 1., {0, 1}, 0, false});
    while (!stack.empty()) {
      const Visit visit = stack.back();
      stack.pop_back();
      if (envelope_.nearer_than(visit.k, visit.chord.lo, visit.chord.hi)) continue;
      if (visit.leaf)
        use(visit.child);
      else
        push(tree, tie, tree.nodes[visit.child], stack);
    }
  }

  /// Rounding may lose a box at the bow-tie's rim, by parts of 2^-50 of the distances: this query tells what
  /// intervals to look at, not what is seen there.
  void push(const LineTree& tree, const BowTie& tie, const LineNode& node, std::vector<Visit>& stack) {
    ++counters_.nodes_visited;
    const Vec3d focus = tie.focus - tree.centre;
    const Ranges side(tie.side, focus, node), r(tie.r, focus, node), k(tie.k, focus, node),
        s(tie.k - tie.r, focus, node);
    const size_t first = stack.size();
    for (int lane = 0; lane < kWidth; ++lane) {
      if (side.lo[lane] > 0 || side.hi[lane] < 0) continue;
      // Between chord and focus r and s are positive and k below 1, beyond it r and s are negative.
      const bool before =
          !tie.from_focus && r.hi[lane] >= 0 && s.hi[lane] >= 0 && k.hi[lane] >= 0 && k.lo[lane] <= 1;
      const bool beyond = r.lo[lane] <= 0 && s.lo[lane] <= 0 && k.lo[lane] <= 0;
      if (!before && !beyond) continue;
      if (!(node.lo[0][lane] <= node.hi[0][lane])) continue;  // an unused lane
      const Range chord = chord_range(r.lo[lane], r.hi[lane], k.lo[lane], k.hi[lane]);
      const double nearest = before ? std::min(k.hi[lane], 1.) : std::min(k.hi[lane], 0.);
      stack.push_back({nearest, chord, node.child[lane], (node.leaves >> lane & 1) != 0});
    }
    std::sort(stack.begin() + ptrdiff_t(first), stack.end(),
              [](const Visit& p, const Visit& q) { return p.k < q.k; });
  }

  const LineBvh& bvh_;
  LowerEnvelope& envelope_;
  QueryCounters& counters_;
  bool from_focus_ = false;
};

PrimitiveId id_of(const LineBvh& bvh, const PieceLabel& label) {
  if (label == kNothingThere) return {};
  if (label.instance == kTubeLabel) {
    const auto& starts = bvh.tubes.first_segment;
    const auto mesh = std::upper_bound(starts.begin(), starts.end(), label.triangle) - 1;
    return {kNone, bvh.tubes.meshes[size_t(mesh - starts.begin())], label.triangle - *mesh};
  }
  const auto& first = bvh.first_triangle;
  const auto mesh =
      uint32_t(std::upper_bound(first.begin(), first.end(), label.triangle) - first.begin() - 1);
  return {label.instance, mesh, label.triangle - first[mesh]};
}

}  // namespace

void nearest_along(const LineBvh& bvh, const FocusedChord& chord, std::vector<SeenInterval>& out,
                   QueryCounters& counters) {
  ++counters.line_queries;
  thread_local LowerEnvelope envelope;
  envelope.reset();
  BowTieWalk(bvh, envelope, counters).run(chord);
  seen_of(bvh, envelope, out);
}

void seen_of(const LineBvh& bvh, const LowerEnvelope& envelope, std::vector<SeenInterval>& out) {
  out.clear();
  for (const LowerEnvelope::Item& item : envelope.items()) {
    const PrimitiveId id = id_of(bvh, item.label);
    if (!out.empty() && out.back().id == id)
      out.back().hi = item.hi;
    else
      out.push_back({item.lo, item.hi, id});
  }
}

}  // namespace penumbra
