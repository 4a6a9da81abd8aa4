#pragma once
// What of [0,1] is still visible, while occluders are found in any order: intervals without order, sixteen
// to a vector. Every end is an end of some triangle's interval, taken by comparisons only, so the final set
// does not depend on the order.
#include <utility>

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
    vectors_ = 1;
    clear_vector(0);
    lo_[0] = 0;
    hi_[0] = 1;
    used_ = 1;
  }

  bool overlaps(float lo, float hi) const {
    const S::Floats l = S::all(lo), h = S::all(hi);
    for (int k = 0; k < vectors_; ++k) {
      if (S::bits(S::both(S::less(low(k), h), S::less(l, high(k)))) != 0) return true;
    }
    return false;
  }

  /// Removes [lo,hi], lo < hi. True if anything went.
  bool subtract(float lo, float hi) {
    const S::Floats l = S::all(lo), h = S::all(hi);
    bool changed = false;
    for (int k = 0; k < vectors_; ++k) {
      const S::Floats a = low(k), b = high(k);
      const S::Mask cut = S::both(S::less(a, h), S::less(l, b));
      if (S::bits(cut) == 0) continue;
      changed = true;
      const S::Mask keeps_left = S::both(cut, S::less(a, l)), keeps_right = S::both(cut, S::less(h, b));
      if (const uint32_t split = S::bits(S::both(keeps_left, keeps_right))) {
        const int lane = kWidth * k + std::countr_zero(split);
        const float end = hi_[lane];
        hi_[lane] = lo;
        add(hi, end);
        return true;  // [lo,hi] lies inside this one
      }
      const S::Mask gone = S::without(S::without(cut, keeps_left), keeps_right);
      S::store(lo_ + kWidth * k, S::select(gone, S::all(kNoLo), S::select(keeps_right, h, a)));
      S::store(hi_ + kWidth * k, S::select(gone, S::all(kNoHi), S::select(keeps_left, l, b)));
    }
    return changed;
  }

  /// Smallest interval that holds all; lo > hi if nothing is left.
  std::pair<float, float> hull() const {
    S::Floats a = low(0), b = high(0);
    for (int k = 1; k < vectors_; ++k) {
      a = S::min(a, low(k));
      b = S::max(b, high(k));
    }
    return {S::lowest(a), S::highest(b)};
  }

  /// The widest hidden stretch between two visible intervals; lo >= hi if there is none.
  std::pair<float, float> widest_gap() const {
    std::pair<float, float> widest{0, 0};
    for (int i = 0; i < used_; ++i) {
      if (!(lo_[i] < hi_[i])) continue;
      float next = kNoLo;
      for (int k = 0; k < vectors_; ++k) {
        const S::Floats a = low(k);
        next = std::min(next, S::lowest(S::select(S::less(S::all(hi_[i]), a), a, S::all(kNoLo))));
      }
      if (next < kNoLo && next - hi_[i] > widest.second - widest.first) widest = {hi_[i], next};
    }
    return widest;
  }

  int lanes() const { return used_; }
  Interval lane(int i) const { return {lo_[i], hi_[i]}; }

 private:
  // An unused lane overlaps nothing.
  static constexpr float kNoLo = 2, kNoHi = -1;

  S::Floats low(int k) const { return S::load(lo_ + kWidth * k); }
  S::Floats high(int k) const { return S::load(hi_ + kWidth * k); }
  void clear_vector(int k) {
    S::store(lo_ + kWidth * k, S::all(kNoLo));
    S::store(hi_ + kWidth * k, S::all(kNoHi));
  }

  void add(float lo, float hi) {
    if (used_ == kWidth * vectors_) make_room();
    lo_[used_] = lo;
    hi_[used_] = hi;
    ++used_;
  }

  /// Closes the holes of removed intervals; then takes another vector if that was not enough.
  [[gnu::noinline]] void make_room() {
    int kept = 0;
    for (int i = 0; i < used_; ++i) {
      if (!(lo_[i] < hi_[i])) continue;
      lo_[kept] = lo_[i];
      hi_[kept++] = hi_[i];
    }
    for (int i = kept; i < used_; ++i) lo_[i] = kNoLo, hi_[i] = kNoHi;
    used_ = kept;
    if (used_ < kWidth * vectors_) return;
    if (static_cast<size_t>(kWidth * (vectors_ + 1)) > workspace_.lo.size()) {
      workspace_.grow_set();
      lo_ = workspace_.lo.data();
      hi_ = workspace_.hi.data();
    }
    clear_vector(vectors_++);
  }

  LineWorkspace& workspace_;
  float *lo_, *hi_;
  int used_ = 0, vectors_ = 1;
};

}  // namespace
}  // namespace penumbra
