#pragma once
namespace penumbra {

/// A part of an axis on one side of the foot of x, mirrored to 0 <= lo <= hi. width = hi − lo is kept apart:
/// the difference of large ends has lost its digits.
struct AxisPart {
  double lo, hi, width;
};

/// [start, start + width], split at the foot.
class AxisParts {
 public:
  AxisParts(double start, double width) {
    const double end = start + width;
    if (start >= 0) {
      parts_[count_++] = {start, end, width};
    } else if (end <= 0) {
      parts_[count_++] = {-end, -start, width};
    } else {
      parts_[count_++] = {0, end, end};
      parts_[count_++] = {0, -start, -start};
    }
  }
  const AxisPart* begin() const { return parts_; }
  const AxisPart* end() const { return parts_ + count_; }

 private:
  AxisPart parts_[2];
  int count_ = 0;
};

}  // namespace penumbra
