#pragma once
// How far x is from the points of a chord, and where on the chord a distance is met.
#include "scenes/math.h"

namespace penumbra {

/// Of P(s) = a + s · along, seen from x: r(s)² = d² + L² (s − foot)², d the distance of the chord's whole
/// line.
class ChordDistance {
 public:
  /// `a`: the chord's first end minus x.
  ChordDistance(const Vec3d& a, const Vec3d& along);

  double at(double s) const;
  /// Where the line is nearest; may lie outside [0,1].
  double foot() const { return foot_; }
  /// s <= foot, s >= foot where the distance is r; the foot itself if the line is nowhere so near. ±infinity
  /// on a chord of length 0 for an r that it is nearer than.
  double before(double r) const { return foot_ - half_width(r); }
  double after(double r) const { return foot_ + half_width(r); }

 private:
  double half_width(double r) const;
  double d_ = 0, length_ = 0, foot_ = 0;
};

}  // namespace penumbra
