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
  void set_up(const LineFan& fan, const LineTree& tree) {
    x_ = vector(Vec3f(fan.x_exact - tree.centre));
    a_ = vector(Vec3f(fan.a));
    chord_ = vector(Vec3f(fan.b - fan.a));
    sign_ = _mm_andnot_ps(_mm_cmplt_ps(_mm_setzero_ps(), vector(fan.g)), _mm_set1_ps(-0.f));
    slack_ = static_cast<float>(fan.slack);
    alignas(16) float x[4];
    _mm_store_ps(x, x_);
    float d = 0, size = 0;
    for (int k = 0; k < 3; ++k) {
      plane_[k] = fan.g[k];
      highest_[k] = row(k, fan.g[k] > 0);
      lowest_[k] = row(k, !(fan.g[k] > 0));
      d -= fan.g[k] * x[k];
      size += std::abs(fan.g[k]);
    }
    above_ = d + slack_ * size;
    below_ = d - slack_ * size;
    const __m128 longer = _mm_max_ps(magnitude(a_), magnitude(_mm_add_ps(a_, chord_)));
    alignas(16) float l[4];
    _mm_store_ps(l, longer);
    margin_ = slack_ * std::max({l[0], l[1], l[2]});
  }

  /// The part of the chord that is still of interest.
  void narrow(Interval part) {
    const __m128 e0 = at(part.lo), e1 = at(part.hi), zero = _mm_setzero_ps(), slack = _mm_set1_ps(slack_);
    _mm_store_ps(box_lo_, _mm_sub_ps(_mm_add_ps(x_, _mm_min_ps(zero, _mm_min_ps(e0, e1))), slack));
    _mm_store_ps(box_hi_, _mm_add_ps(_mm_add_ps(x_, _mm_max_ps(zero, _mm_max_ps(e0, e1))), slack));
    set(sides_[0], e0, sign_, true);
    set(sides_[1], e1, minus(sign_), true);
  }

  /// A hidden stretch: boxes that lie wholly within it are of no interest.
  void skip(Interval gap) {
    has_gap_ = gap.lo < gap.hi;
    if (!has_gap_) return;
    set(gap_[0], at(gap.lo), sign_, false);
    set(gap_[1], at(gap.hi), minus(sign_), false);
  }

  /// Bit k: box k may meet the fan.
  uint32_t meeting(const LineNode& node) const {
    const float* rows = node.lo[0];
    const S::Floats above = plane(rows, highest_, above_), below = plane(rows, lowest_, below_);
    S::Floats least = above;
    for (const Sides& s : sides_)
      for (int k = 0; k < 3; ++k) least = S::min(least, s.at(rows, k));
    S::Mask met = S::both(S::less_equal(S::all(0), least), S::less_equal(below, S::all(0)));
    for (int k = 0; k < 3; ++k) {
      met = S::both(met, S::both(S::less_equal(S::load(rows + row(k, false)), S::all(box_hi_[k])),
                                 S::less_equal(S::all(box_lo_[k]), S::load(rows + row(k, true)))));
    }
    if (has_gap_) {
      const S::Floats after = gap_[0].most(rows), before = gap_[1].most(rows);
      met = S::without(met, S::less(S::all(0), S::min(after, before)));
    }
    return S::bits(met);
  }

 private:
  /// Three affine functions, each of two coordinates of a box's corner, the corner chosen by the
  /// coefficients' signs: function k leaves out axis k.
  struct Sides {
    alignas(16) float c0[4], c1[4], d[4];
    alignas(16) int32_t row0[4], row1[4];
    S::Floats at(const float* rows, int k) const {
      return S::fma(S::all(c1[k]), S::load(rows + row1[k]),
                    S::fma(S::all(c0[k]), S::load(rows + row0[k]), S::all(d[k])));
    }
    S::Floats most(const float* rows) const { return S::max(S::max(at(rows, 0), at(rows, 1)), at(rows, 2)); }
  };

  /// Where a node's row begins, in floats.
  static constexpr int32_t row(int k, bool upper) { return (upper ? 3 + k : k) * kWidth; }

  static __m128 vector(const Vec3f& v) { return _mm_setr_ps(v.x, v.y, v.z, 0); }
  static __m128 magnitude(__m128 v) { return _mm_andnot_ps(_mm_set1_ps(-0.f), v); }
  static __m128 minus(__m128 v) { return _mm_xor_ps(_mm_set1_ps(-0.f), v); }
  static __m128 next(__m128 v) { return _mm_shuffle_ps(v, v, _MM_SHUFFLE(3, 0, 2, 1)); }
  static __m128 next_but_one(__m128 v) { return _mm_shuffle_ps(v, v, _MM_SHUFFLE(3, 1, 0, 2)); }

  __m128 at(float v) const { return _mm_add_ps(a_, _mm_mul_ps(chord_, _mm_set1_ps(v))); }

  /// sign_k (e_k × e)·(p - x) for all k, signs as sign bits: at its largest over the box, plus slack; or at
  /// its smallest, minus slack.
  void set(Sides& s, __m128 e, __m128 sign, bool largest) const {
    const __m128 c0 = _mm_xor_ps(next_but_one(e), minus(sign)), c1 = _mm_xor_ps(next(e), sign);
    const __m128 slack = _mm_set1_ps(largest ? margin_ : -margin_), zero = _mm_setzero_ps();
    const __m128 d =
        _mm_sub_ps(slack, _mm_add_ps(_mm_mul_ps(c0, next(x_)), _mm_mul_ps(c1, next_but_one(x_))));
    const __m128i lower0 = _mm_setr_epi32(row(1, false), row(2, false), row(0, false), 0),
                  lower1 = _mm_setr_epi32(row(2, false), row(0, false), row(1, false), 0),
                  upper = _mm_set1_epi32(row(0, true));
    const __m128 all = _mm_castsi128_ps(_mm_set1_epi32(largest ? 0 : -1));
    const auto choose = [&](__m128 c, __m128i lower) {
      const __m128 up = _mm_xor_ps(_mm_cmplt_ps(zero, c), all);
      return _mm_add_epi32(lower, _mm_and_si128(_mm_castps_si128(up), upper));
    };
    _mm_store_ps(s.c0, c0);
    _mm_store_ps(s.c1, c1);
    _mm_store_ps(s.d, d);
    _mm_store_si128(reinterpret_cast<__m128i*>(s.row0), choose(c0, lower0));
    _mm_store_si128(reinterpret_cast<__m128i*>(s.row1), choose(c1, lower1));
  }

  S::Floats plane(const float* rows, const int32_t corner[3], float d) const {
    S::Floats f = S::fma(S::all(plane_[0]), S::load(rows + corner[0]), S::all(d));
    f = S::fma(S::all(plane_[1]), S::load(rows + corner[1]), f);
    return S::fma(S::all(plane_[2]), S::load(rows + corner[2]), f);
  }

  __m128 x_, a_, chord_;
  __m128 sign_;  ///< of the plane's normal: -0 where a component is not positive, as a sign bit
  float slack_, margin_;
  float plane_[3], above_, below_;
  int32_t highest_[3], lowest_[3];
  alignas(16) float box_lo_[4], box_hi_[4];
  Sides sides_[2], gap_[2];
  bool has_gap_;
};

}  // namespace
}  // namespace penumbra
