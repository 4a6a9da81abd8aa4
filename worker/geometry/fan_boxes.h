#pragma once
// Which of a node's sixteen boxes can meet the part [V0,V1] of a fan, exactly up to the fan's slack: the
// separating-axis test of a triangle (x, x+E0, x+E1), E(v) = A + v (B-A), against boxes.
//
// In the fan's plane v >= V0 means (N×E0)·q >= 0. The axes e_k × E0 have that direction in the plane, with
// the sign of N_k (split e_k into its parts along and across N), so a box is left of V0 if, for some k, all
// of it has sgn(N_k) (e_k×E0)·q < 0. For V1 the same with E1×e_k. One product less per axis than N×E itself,
// and exact for boxes.
#include <algorithm>
#include <cmath>

#include "worker/geometry/line_bvh.h"
#include "worker/geometry/simd.h"

namespace penumbra {
namespace {

class FanBoxes {
  using S = Simd;

 public:
  FanBoxes(const LineFan& fan, const LineTree& tree)
      : x_(fan.x_exact - tree.centre),
        a_(fan.a),
        chord_(fan.b - fan.a),
        slack_(static_cast<float>(fan.slack)) {
    float d = 0, size = 0;
    for (int k = 0; k < 3; ++k) {
      sign_[k] = fan.g[k] > 0 ? 1.f : -1.f;
      plane_[k] = fan.g[k];
      highest_[k] = row(k, fan.g[k] > 0);
      lowest_[k] = row(k, !(fan.g[k] > 0));
      d -= fan.g[k] * x_[k];
      size += std::abs(fan.g[k]);
    }
    above_ = d + slack_ * size;
    below_ = d - slack_ * size;
    for (int k = 0; k < 3; ++k) length_ = std::max({length_, std::abs(a_[k]), std::abs(a_[k] + chord_[k])});
  }

  /// The part of the chord that is still of interest.
  void narrow(Interval part) {
    const Vec3f e0 = a_ + chord_ * part.lo, e1 = a_ + chord_ * part.hi;
    for (int k = 0; k < 3; ++k) {
      box_lo_[k] = x_[k] + std::min({0.f, e0[k], e1[k]}) - slack_;
      box_hi_[k] = x_[k] + std::max({0.f, e0[k], e1[k]}) + slack_;
    }
    if (part.lo != part_.lo) {
      for (int k = 0; k < 3; ++k) sides_[k] = side(k, e0, sign_[k], true);
    }
    if (part.hi != part_.hi) {
      for (int k = 0; k < 3; ++k) sides_[3 + k] = side(k, e1, -sign_[k], true);
    }
    part_ = part;
  }

  /// A hidden stretch: boxes that lie wholly within it are of no interest.
  void skip(Interval gap) {
    if (gap == skipped_) return;
    skipped_ = gap;
    has_gap_ = gap.lo < gap.hi;
    const Vec3f e0 = a_ + chord_ * gap.lo, e1 = a_ + chord_ * gap.hi;
    for (int k = 0; k < 3; ++k) {
      gap_[k] = side(k, e0, sign_[k], false);
      gap_[3 + k] = side(k, e1, -sign_[k], false);
    }
  }

  /// Bit k: box k may meet the fan.
  uint32_t meeting(const LineNode& node) const {
    const float(*rows)[kWidth] = node.lo;
    const S::Floats above = plane(rows, highest_, above_), below = plane(rows, lowest_, below_);
    S::Floats least = above;
    for (const Side& s : sides_) least = S::min(least, s.at(rows));
    S::Mask met = S::both(S::less_equal(S::all(0), least), S::less_equal(below, S::all(0)));
    for (int k = 0; k < 3; ++k) {
      met = S::both(met, S::both(S::less_equal(S::load(rows[k]), S::all(box_hi_[k])),
                                 S::less_equal(S::all(box_lo_[k]), S::load(rows[3 + k]))));
    }
    if (has_gap_) {
      const S::Floats after = S::max(S::max(gap_[0].at(rows), gap_[1].at(rows)), gap_[2].at(rows));
      const S::Floats before = S::max(S::max(gap_[3].at(rows), gap_[4].at(rows)), gap_[5].at(rows));
      met = S::without(met, S::less(S::all(0), S::min(after, before)));
    }
    return S::bits(met);
  }

 private:
  /// An affine function of two coordinates of a box's corner, the corner chosen by the coefficients' signs.
  struct Side {
    int row0 = 0, row1 = 0;
    float c0 = 0, c1 = 0, d = 0;
    S::Floats at(const float (*rows)[kWidth]) const {
      return S::fma(S::all(c1), S::load(rows[row1]), S::fma(S::all(c0), S::load(rows[row0]), S::all(d)));
    }
  };

  static int row(int k, bool upper) { return upper ? 3 + k : k; }

  /// sign (e_k × e)·(p - x): at its largest over the box, plus slack; or at its smallest, minus slack.
  Side side(int k, const Vec3f& e, float sign, bool largest) const {
    const int j = (k + 1) % 3, m = (k + 2) % 3;
    const float cj = -sign * e[m], cm = sign * e[j];
    const float slack = largest ? slack_ * length_ : -slack_ * length_;
    return Side{row(j, (cj > 0) == largest), row(m, (cm > 0) == largest), cj, cm,
                slack - (cj * x_[j] + cm * x_[m])};
  }

  S::Floats plane(const float (*rows)[kWidth], const int corner[3], float d) const {
    S::Floats f = S::fma(S::all(plane_[0]), S::load(rows[corner[0]]), S::all(d));
    f = S::fma(S::all(plane_[1]), S::load(rows[corner[1]]), f);
    return S::fma(S::all(plane_[2]), S::load(rows[corner[2]]), f);
  }

  Vec3f x_, a_, chord_;
  float slack_, length_ = 0;
  float sign_[3], plane_[3], above_, below_;
  int highest_[3], lowest_[3];
  float box_lo_[3], box_hi_[3];
  Side sides_[6], gap_[6];
  bool has_gap_ = false;
  Interval part_{-1, -1}, skipped_{0, 0};
};

}  // namespace
}  // namespace penumbra
