#include "worker/geometry/intervals.h"

#include "proto/status.h"

namespace penumbra {

bool IntervalSet::subtract(float lo, float hi) {
  if (!(lo < hi)) return false;
  // Visible intervals are open against what hides them: sharing just an end removes nothing.
  auto first = std::find_if(items_.begin(), items_.end(), [lo](const Interval& i) { return lo < i.hi; });
  if (first == items_.end() || !(first->lo < hi)) return false;
  auto last = std::find_if(first, items_.end(), [hi](const Interval& i) { return !(i.lo < hi); });
  const Interval left{first->lo, lo}, right{hi, (last - 1)->hi};
  const bool keeps_left = left.lo < left.hi, keeps_right = right.lo < right.hi;
  if (keeps_left && keeps_right && last - first == 1) {
    *first = left;
    items_.insert(last, right);
    return true;
  }
  if (keeps_left) *first++ = left;
  if (keeps_right) *--last = right;
  items_.erase(first, last);
  return true;
}

void IntervalSet::append(float lo, float hi) {
  PENUMBRA_CHECK(items_.empty() || items_.back().hi <= lo);
  if (!(lo < hi)) return;
  if (!items_.empty() && items_.back().hi == lo) {
    items_.back().hi = hi;
  } else {
    items_.push_back({lo, hi});
  }
}

float IntervalSet::length() const {
  float sum = 0;
  for (const Interval& i : items_) sum += i.length();
  return sum;
}

bool IntervalSet::contains(float v) const {
  for (const Interval& i : items_) {
    if (i.lo <= v && v <= i.hi) return true;
  }
  return false;
}

}  // namespace penumbra
