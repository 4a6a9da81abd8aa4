#pragma once
// What blocks hide of a chord, on its way to the visible set: intervals of many triangles at once, and lanes
// that are still in doubt.
#include "worker/geometry/line_bvh.h"
#include "worker/geometry/simd.h"
#include "worker/geometry/visible_set.h"

namespace penumbra {
namespace {

/// Lanes of a block that single precision cannot decide.
struct Doubt {
  const PairBlock* block;
  uint16_t lanes;        ///< counted from `at`, as are the next
  uint16_t shared, to0;  ///< lanes in which the plane separates corners 0 and 1; 0 and the triangle's own
  uint8_t at;            ///< first lane of the register
  uint8_t which;         ///< triangle of the pair

  /// Which corner of the pair is alone on its side of the plane.
  int odd_corner(int lane) const {
    if (!(shared >> lane & 1)) return 2 + which;
    return to0 >> lane & 1 ? 0 : 1;
  }
};

/// Hidden intervals that wait to be taken from the visible set, of at most kBlocks blocks.
class HiddenIntervals {
  using R = Register;

 public:
  static constexpr int kBlocks = 2 * kWidth;  // the leaves of two nodes

  void add(uint32_t chosen, R::Floats lo, R::Floats hi) {
    R::compress(lo_ + count_, lo, hi_ + count_, hi, chosen);
    count_ += std::popcount(chosen);
  }
  void add(Interval i) {
    lo_[count_] = i.lo;
    hi_[count_++] = i.hi;
  }
  /// Written always and kept if it has lanes: a branch here is one that the processor guesses wrong.
  void doubt(const Doubt& d) {
    doubts_[doubt_count_] = d;
    doubt_count_ += d.lanes != 0;
  }
  std::span<const Doubt> doubts() const { return {doubts_, static_cast<size_t>(doubt_count_)}; }
  void no_more_doubts() { doubt_count_ = 0; }
  bool empty() const { return count_ == 0; }

  /// Takes all of them from the set, whole connected stretches at a time. True if that changed it.
  bool flush(VisibleSet& visible) {
    bool changed = false;
    for (int first = 0; first < count_; first += R::kLanes) {
      const R::Floats lo = R::load_unaligned(lo_ + first), hi = R::load_unaligned(hi_ + first);
      const R::Mask meets = R::both(R::first(count_ - first), visible.meeting(lo, hi));
      if (R::bits(meets) == 0) continue;
      changed |= take(visible, R::select(meets, lo, R::all(kNoLo)), R::select(meets, hi, R::all(kNoHi)));
    }
    count_ = 0;
    return changed;
  }

 private:
  // Both triangles of every lane of every block, and the whole vector that a compressed store writes.
  static constexpr int kCapacity = (2 * kBlocks + 1) * kWidth;

  /// Subtracts the connected stretches of a union of intervals.
  static bool take(VisibleSet& visible, R::Floats lo, R::Floats hi) {
    alignas(64) float lows[R::kLanes], highs[R::kLanes];
    R::store(lows, lo);
    R::store(highs, hi);
    // An end is one of the union's if no other interval holds it and goes on.
    R::Mask inner = R::less(hi, R::all(0));
    for (int j = 0; j < R::kLanes; ++j)
      inner = R::either(inner, R::both(R::less_equal(R::all(lows[j]), hi), R::less(hi, R::all(highs[j]))));
    const uint32_t last = R::bits(inner) ^ ((1u << R::kLanes) - 1);
    if ((last & (last - 1)) == 0) return visible.subtract(R::lowest(lo), highs[std::countr_zero(last)]);
    const R::Floats ends = R::select(inner, R::all(kNoLo), hi);
    // Stretch by stretch: what starts behind one's end belongs to the next.
    bool changed = false;
    for (float start = R::lowest(lo); start < kNoLo;) {
      const float end = R::lowest(R::select(R::less(R::all(start), ends), ends, R::all(kNoLo)));
      changed |= visible.subtract(start, end);
      start = R::lowest(R::select(R::less(R::all(end), lo), lo, R::all(kNoLo)));
    }
    return changed;
  }

  // What a lane without an interval holds.
  static constexpr float kNoLo = 2, kNoHi = -1;

  int count_ = 0, doubt_count_ = 0;
  Doubt doubts_[2 * kBlocks * kWidth / Register::kLanes + 1];
  alignas(64) float lo_[kCapacity], hi_[kCapacity];
};

}  // namespace
}  // namespace penumbra
