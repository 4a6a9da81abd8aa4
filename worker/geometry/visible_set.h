#pragma once
// What of [0,1] is still visible, while occluders are found in any order. Every end is an end of some
// triangle's interval, taken by comparisons only, so the final set does not depend on the order.
#include <algorithm>

#include "worker/geometry/line_workspace.h"
#include "worker/geometry/simd.h"

namespace penumbra {
namespace {

class VisibleSet {
  using S = Simd;

 public:
  explicit VisibleSet(LineWorkspace& workspace)
      : workspace_(workspace), lo_(workspace.lo.data()), hi_(workspace.hi.data()) {}

  void reset() {
    lo_[0] = 0;
    hi_[0] = 1;
    count_ = 1;
  }
  bool empty() const { return count_ == 0; }
  int size() const { return count_; }
  Interval operator[](int i) const { return {lo_[i], hi_[i]}; }
  /// Smallest interval that holds all of a set that is not empty.
  Interval hull() const { return {lo_[0], hi_[count_ - 1]}; }

  /// Intervals of which some part may be visible. Exact for the few intervals that there mostly are.
  S::Mask meeting(S::Floats lo, S::Floats hi) const {
    constexpr int kFew = 8;
    if (count_ > kFew) return S::mask(0xffff);
    S::Mask met = S::mask(0);
    for (int i = 0; i < count_; ++i) {
      met = S::either(met, S::both(S::less(lo, S::all(hi_[i])), S::less(S::all(lo_[i]), hi)));
    }
    return met;
  }

  /// Removes [lo,hi], lo < hi. True if anything went.
  bool subtract(float lo, float hi) {
    int first = 0;
    while (first < count_ && !(lo < hi_[first])) ++first;
    int last = first;
    while (last < count_ && lo_[last] < hi) ++last;
    if (first == last) return false;
    const bool keeps_left = lo_[first] < lo, keeps_right = hi < hi_[last - 1];
    if (keeps_left && keeps_right && last - first == 1) {
      split(first, lo, hi);
      return true;
    }
    if (keeps_left) hi_[first++] = lo;
    if (keeps_right) lo_[--last] = hi;
    erase(first, last);
    return true;
  }

  /// The widest hidden stretch between two visible intervals; empty if there is none.
  Interval widest_gap() const {
    Interval widest{0, 0};
    for (int i = 1; i < count_; ++i) {
      if (lo_[i] - hi_[i - 1] > widest.length()) widest = {hi_[i - 1], lo_[i]};
    }
    return widest;
  }

 private:
  void erase(int first, int last) {
    if (first == last) return;
    std::copy(lo_ + last, lo_ + count_, lo_ + first);
    std::copy(hi_ + last, hi_ + count_, hi_ + first);
    count_ -= last - first;
  }

  void split(int i, float lo, float hi) {
    if (static_cast<size_t>(count_) + 1 > workspace_.lo.size()) {
      workspace_.grow_set();
      lo_ = workspace_.lo.data();
      hi_ = workspace_.hi.data();
    }
    std::copy_backward(lo_ + i + 1, lo_ + count_, lo_ + count_ + 1);
    std::copy_backward(hi_ + i, hi_ + count_, hi_ + count_ + 1);
    hi_[i] = lo;
    lo_[i + 1] = hi;
    ++count_;
  }

  LineWorkspace& workspace_;
  float *lo_, *hi_;
  int count_ = 0;
};

}  // namespace
}  // namespace penumbra
