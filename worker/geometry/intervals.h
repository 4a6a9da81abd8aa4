#pragma once
// Disjoint intervals of [0,1] in ascending order: the visible part of a line.
#include <algorithm>
#include <vector>

namespace penumbra {

struct Interval {
  float lo = 0, hi = 0;
  float length() const { return hi - lo; }
  bool operator==(const Interval&) const = default;
};

/// Grows as it must; touching intervals are one. Empty set: nothing visible.
class IntervalSet {
 public:
  /// The whole of [lo,hi].
  void reset(float lo = 0, float hi = 1) {
    items_.clear();
    if (lo < hi) items_.push_back({lo, hi});
  }
  void clear() { items_.clear(); }
  /// Appends [lo,hi]; lo must not be below what the set ends with. Touching is merged, empty is dropped.
  void append(float lo, float hi);
  /// Removes [lo,hi]; an empty or reversed interval removes nothing. True if anything went.
  bool subtract(float lo, float hi);
  bool empty() const { return items_.empty(); }
  size_t size() const { return items_.size(); }
  const Interval& operator[](size_t i) const { return items_[i]; }
  auto begin() const { return items_.begin(); }
  auto end() const { return items_.end(); }
  /// Sum of the lengths; in [0,1] for a subset of [0,1].
  float length() const;
  /// Ends count as inside.
  bool contains(float v) const;
  bool operator==(const IntervalSet&) const = default;

 private:
  std::vector<Interval> items_;
};

}  // namespace penumbra
