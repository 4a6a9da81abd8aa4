#pragma once
// Which of a node's sixteen boxes can meet the part [V0,V1] of a fan, exactly up to the fan's slack: the
// separating-axis test of a triangle (x, x+E0, x+E1), E(v) = A + v (B-A), against boxes.
//
// In the fan's plane v >= V0 means (N×E0)·q >= 0. The axes e_k × E0 have that direction in the plane, with
// the sign of N_k (split e_k into its parts along and across N), so a box is left of V0 if, for some k, all
// of it has sgn(N_k) (e_k×E0)·q < 0. For V1 the same with E1×e_k. One product less per axis than N×E itself,
// and exact for boxes.
//
// The largest c·p over a box is c·(lo+hi)/2 + |c|·(hi-lo)/2: no corner has to be chosen by signs, so every
// operand of a node stays in its register. In units of u |c|₁ reach its roundings are at most: the sum and the
// extent 1 each, the constant 4, x relative to the centre 1, the direction e 6, four multiply-adds 8; with
// |c|₁ <= 2 |e| that is 42 of the 64 that the fan's slack allows for.
#include <algorithm>
#include <cmath>

#include "worker/geometry/lanes.h"
#include "worker/geometry/line_bvh.h"

namespace penumbra {
namespace {

class FanBoxes {
  using S = Lanes;

 public:
  /// For the part of the chord that is of interest.
  FanBoxes(const LineFan& fan, const LineTree& tree, Interval part)
      : x_(fan.x_exact - tree.centre),
        a_(fan.a),
        chord_(fan.b - fan.a),
        slack_(static_cast<float>(fan.slack)) {
    float d = 0, size = 0, length = 0;
    for (int k = 0; k < 3; ++k) {
      sign_[k] = fan.g[k] > 0 ? 0.5f : -0.5f;
      plane_[k] = S::all(0.5f * fan.g[k]);
      plane_size_[k] = S::all(0.5f * std::abs(fan.g[k]));
      d -= fan.g[k] * x_[k];
      size += std::abs(fan.g[k]);
      length = std::max({length, std::abs(a_[k]), std::abs(a_[k] + chord_[k])});
    }
    plane_at_ = S::all(d);
    plane_slack_ = S::all(slack_ * size);
    side_slack_ = slack_ * length;
    const Vec3f e0 = at(part.lo), e1 = at(part.hi);
    set_bounds(e0, e1);
    set_start(e0);
    set_end(e1);
    part_ = part;
  }

  /// Less of it is still of interest.
  void narrow(Interval part) {
    const Vec3f e0 = at(part.lo), e1 = at(part.hi);
    set_bounds(e0, e1);
    if (part.lo != part_.lo) set_start(e0);
    if (part.hi != part_.hi) set_end(e1);
    part_ = part;
  }

  /// A hidden stretch: boxes that lie wholly within it are of no interest.
  void skip(Interval gap) {
    if (gap == skipped_) return;
    skipped_ = gap;
    has_gap_ = gap.lo < gap.hi;
    if (!has_gap_) return;
    const Vec3f e0 = at(gap.lo), e1 = at(gap.hi);
    for (int k = 0; k < 3; ++k) {
      set_side(gap_[k], k, e0, sign_[k], -side_slack_);
      set_side(gap_[3 + k], k, e1, -sign_[k], -side_slack_);
    }
  }

  /// Bit k: box k may meet the fan.
  uint32_t meeting(const LineNode& node) const {
    uint32_t met = 0;
    for (int first = 0; first < kWidth; first += S::kLanes) {
      met |= meeting_lanes(node.lo[0] + first) << first;
    }
    return met;
  }

 private:
  /// An affine function of two coordinates, halved for sums and differences of a box's ends.
  struct Side {
    S::Floats c0, c1, size0, size1, d;
  };

  Vec3f at(float v) const { return a_ + chord_ * v; }

  void set_bounds(const Vec3f& e0, const Vec3f& e1) {
    for (int k = 0; k < 3; ++k) {
      box_lo_[k] = S::all(x_[k] + std::min({0.f, e0[k], e1[k]}) - slack_);
      box_hi_[k] = S::all(x_[k] + std::max({0.f, e0[k], e1[k]}) + slack_);
    }
  }
  void set_start(const Vec3f& e0) {
    for (int k = 0; k < 3; ++k) set_side(sides_[k], k, e0, sign_[k], side_slack_);
  }
  void set_end(const Vec3f& e1) {
    for (int k = 0; k < 3; ++k) set_side(sides_[3 + k], k, e1, -sign_[k], side_slack_);
  }

  /// sign (e_k × e)·(p - x), half a sign being given.
  void set_side(Side& side, int k, const Vec3f& e, float half_sign, float slack) const {
    const int j = (k + 1) % 3, m = (k + 2) % 3;
    const float cj = -half_sign * e[m], cm = half_sign * e[j];
    side.c0 = S::all(cj);
    side.c1 = S::all(cm);
    side.size0 = S::all(std::abs(cj));
    side.size1 = S::all(std::abs(cm));
    side.d = S::all(slack - 2 * (cj * x_[j] + cm * x_[m]));
  }

  struct Boxes {
    S::Floats sum[3], size[3];  ///< twice the centre, and the extent
  };
  /// The side's largest value over the boxes.
  static S::Floats largest(const Side& s, int k, const Boxes& b) {
    const int j = (k + 1) % 3, m = (k + 2) % 3;
    const S::Floats centre = S::fma(s.c1, b.sum[m], S::fma(s.c0, b.sum[j], s.d));
    return S::fma(s.size1, b.size[m], S::fma(s.size0, b.size[j], centre));
  }
  static S::Floats smallest(const Side& s, int k, const Boxes& b) {
    const int j = (k + 1) % 3, m = (k + 2) % 3;
    const S::Floats centre = S::fma(s.c1, b.sum[m], S::fma(s.c0, b.sum[j], s.d));
    return S::sub(centre, S::fma(s.size1, b.size[m], S::mul(s.size0, b.size[j])));
  }

  /// meeting() for one register's boxes; their six rows begin at `rows`.
  uint32_t meeting_lanes(const float* rows) const {
    Boxes b;
    S::Floats centre = plane_at_, extent = plane_slack_;
    S::Mask met = S::less_equal(S::load(rows), box_hi_[0]);
    for (int k = 0; k < 3; ++k) {
      const S::Floats lo = S::load(rows + k * kWidth), hi = S::load(rows + (3 + k) * kWidth);
      met = S::both(met, S::both(S::less_equal(lo, box_hi_[k]), S::less_equal(box_lo_[k], hi)));
      b.sum[k] = S::add(lo, hi);
      b.size[k] = S::sub(hi, lo);
      centre = S::fma(plane_[k], b.sum[k], centre);
      extent = S::fma(plane_size_[k], b.size[k], extent);
    }
    // An unused lane is no number here, and meets nothing.
    met = S::both(met, S::less_equal(S::abs(centre), extent));
    if (S::bits(met) == 0) return 0;
    S::Floats least = largest(sides_[0], 0, b);
    for (int i = 1; i < 6; ++i) least = S::min(least, largest(sides_[i], i % 3, b));
    met = S::both(met, S::less_equal(S::all(0), least));
    if (!has_gap_) return S::bits(met);
    S::Floats after = smallest(gap_[0], 0, b), before = smallest(gap_[3], 0, b);
    for (int k = 1; k < 3; ++k) {
      after = S::max(after, smallest(gap_[k], k, b));
      before = S::max(before, smallest(gap_[3 + k], k, b));
    }
    return S::bits(S::without(met, S::less(S::all(0), S::min(after, before))));
  }

  S::Floats plane_[3], plane_size_[3], plane_at_, plane_slack_;
  S::Floats box_lo_[3], box_hi_[3];
  Side sides_[6], gap_[6] = {};
  Vec3f x_, a_, chord_;
  float slack_, side_slack_;
  float sign_[3];
  bool has_gap_ = false;
  Interval part_, skipped_{0, 0};
};

}  // namespace
}  // namespace penumbra
