#pragma once
// What of [0,1] is still visible, while occluders are found in any order. Every end is an end of some
// triangle's interval, taken by comparisons only, so the final set does not depend on the order.
#include <algorithm>

#include "worker/geometry/line_workspace.h"
#include "worker/geometry/simd.h"

namespace penumbra {
namespace {

/// As long as its intervals fit into a register, they lie there in any order, and nothing branches on how
/// many they are; beyond that they are a sorted array.
class VisibleSet {
  using R = Register;
  static constexpr uint32_t kAllLanes = (1u << R::kLanes) - 1;

 public:
  /// All of [0,1]; `buffers` are for sets of many intervals.
  void reset(LineBuffers& buffers) {
    buffers_ = &buffers;
    R::store(lo_, R::all(kNoLo));
    R::store(hi_, R::all(kNoHi));
    lo_[0] = 0;
    hi_[0] = 1;
    many_ = 0;
  }
  bool empty() const { return many_ == 0 && live() == 0; }
  /// Smallest interval that holds all of a set that is not empty.
  Interval hull() const {
    if (many_ != 0) return {buffers_->lo[0], buffers_->hi[many_ - 1]};
    return {R::lowest(R::load(lo_)), R::highest(R::load(hi_))};
  }

  /// Of intervals within the hull, those of which some part may be visible.
  R::Mask meeting(R::Floats lo, R::Floats hi) const {
    uint32_t lanes = live();
    if (many_ != 0 || (lanes & (lanes - 1)) == 0) return R::mask(kAllLanes);
    R::Mask met = R::mask(0);
    for (; lanes != 0; lanes &= lanes - 1) {
      const int i = std::countr_zero(lanes);
      met = R::either(met, R::both(R::less(lo, R::all(hi_[i])), R::less(R::all(lo_[i]), hi)));
    }
    return met;
  }

  /// Removes [lo,hi], lo < hi. True if anything went.
  bool subtract(float lo, float hi) {
    if (many_ != 0) return subtract_from_many(lo, hi);
    const R::Floats l = R::load(lo_), h = R::load(hi_), from = R::all(lo), to = R::all(hi);
    const R::Mask met = R::both(R::less(l, to), R::less(from, h));
    const uint32_t met_bits = R::bits(met);
    if (met_bits == 0) return false;
    const R::Mask left = R::both(met, R::less(l, from)), right = R::both(met, R::less(to, h));
    if (R::bits(R::both(left, right)) != 0) return split(std::countr_zero(met_bits), lo, hi);
    const R::Mask gone = R::without(R::without(met, left), right);
    R::store(lo_, R::select(gone, R::all(kNoLo), R::select(right, to, l)));
    R::store(hi_, R::select(gone, R::all(kNoHi), R::select(left, from, h)));
    return true;
  }

  /// The widest hidden stretch between two visible intervals; empty if there is none.
  Interval widest_gap() const {
    if (many_ != 0) return widest_gap_of_many();
    const uint32_t lanes = live();
    if ((lanes & (lanes - 1)) == 0) return {0, 0};
    const R::Floats l = R::load(lo_), h = R::load(hi_);
    R::Floats next = R::all(kNoLo);  // the next interval's start
    for (int j = 0; j < R::kLanes; ++j) {
      const R::Floats start = R::all(lo_[j]);
      next = R::min(next, R::select(R::less_equal(h, start), start, R::all(kNoLo)));
    }
    const R::Mask inner = R::both(R::less(l, h), R::less(next, R::all(kNoLo)));
    const R::Floats length = R::select(inner, R::sub(next, h), R::all(0));
    const int i = std::countr_zero(R::bits(R::less_equal(R::all(R::highest(length)), length)));
    alignas(64) float starts[R::kLanes];
    R::store(starts, next);
    return {hi_[i], starts[i]};
  }

  /// Appends the intervals in ascending order.
  void append_to(IntervalSet& out) {
    if (many_ == 0) sort();
    for (int i = 0; i < many_; ++i) out.append(buffers_->lo[i], buffers_->hi[i]);
  }

 private:
  // What a lane without an interval holds: meets nothing, and is beyond every end.
  static constexpr float kNoLo = 2, kNoHi = -1;

  uint32_t live() const { return R::bits(R::less(R::load(lo_), R::load(hi_))); }

  bool split(int i, float lo, float hi) {
    const uint32_t free = kAllLanes & ~live();
    if (free == 0) {
      sort();
      return subtract_from_many(lo, hi);
    }
    const int j = std::countr_zero(free);
    lo_[j] = hi;
    hi_[j] = hi_[i];
    hi_[i] = lo;
    return true;
  }

  /// From lanes to the sorted array.
  void sort() {
    float *los = buffers_->lo.data(), *his = buffers_->hi.data();
    for (uint32_t lanes = live(); lanes != 0; lanes &= lanes - 1) {
      const int lane = std::countr_zero(lanes);
      int i = many_++;
      for (; i > 0 && lo_[lane] < los[i - 1]; --i) los[i] = los[i - 1], his[i] = his[i - 1];
      los[i] = lo_[lane], his[i] = hi_[lane];
    }
    R::store(lo_, R::all(kNoLo));
    R::store(hi_, R::all(kNoHi));
  }

  bool subtract_from_many(float lo, float hi) {
    float *los = buffers_->lo.data(), *his = buffers_->hi.data();
    int first = 0;
    while (first < many_ && !(lo < his[first])) ++first;
    int last = first;
    while (last < many_ && los[last] < hi) ++last;
    if (first == last) return false;
    const bool keeps_left = los[first] < lo, keeps_right = hi < his[last - 1];
    if (keeps_left && keeps_right && last - first == 1) {
      insert_after(first, hi);
      buffers_->hi[first] = lo;
      return true;
    }
    if (keeps_left) his[first++] = lo;
    if (keeps_right) los[--last] = hi;
    std::copy(los + last, los + many_, los + first);
    std::copy(his + last, his + many_, his + first);
    many_ -= last - first;
    return true;
  }

  /// The array's interval i once more, from `lo` on.
  void insert_after(int i, float lo) {
    if (static_cast<size_t>(many_) + 1 > buffers_->lo.size()) buffers_->grow_set();
    float *los = buffers_->lo.data(), *his = buffers_->hi.data();
    std::copy_backward(los + i + 1, los + many_, los + many_ + 1);
    std::copy_backward(his + i, his + many_, his + many_ + 1);
    los[i + 1] = lo;
    ++many_;
  }

  Interval widest_gap_of_many() const {
    const float *los = buffers_->lo.data(), *his = buffers_->hi.data();
    Interval widest{0, 0};
    for (int i = 1; i < many_; ++i)
      if (los[i] - his[i - 1] > widest.length()) widest = {his[i - 1], los[i]};
    return widest;
  }

  LineBuffers* buffers_;
  alignas(64) float lo_[R::kLanes], hi_[R::kLanes];
  int many_;  ///< intervals in the array; 0: they are in the lanes
};

}  // namespace
}  // namespace penumbra
