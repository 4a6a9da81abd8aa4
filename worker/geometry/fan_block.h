#pragma once
// What sixteen triangles hide of a chord: hidden_by_triangle (line_fan.cpp), lane by lane to the last bit,
// and the union of such intervals.
#include "worker/geometry/line_bvh.h"
#include "worker/geometry/simd.h"
#include "worker/geometry/visible_set.h"

namespace penumbra {
namespace {

/// Lanes of a block that single precision cannot decide.
struct Doubt {
  const TriangleBlock* block;
  uint32_t lanes;
  uint16_t odd1, odd2;  ///< lanes whose odd vertex is 1, or 2
};

/// Hidden intervals that wait to be taken from the visible set, of at most kBlocks blocks.
class HiddenIntervals {
  using S = Simd;

 public:
  static constexpr int kBlocks = 2 * kWidth;  // the leaves of two nodes

  void add(S::Mask chosen, S::Floats lo, S::Floats hi) {
    S::compress(lo_ + count_, chosen, lo);
    S::compress(hi_ + count_, chosen, hi);
    count_ += std::popcount(S::bits(chosen));
  }
  void add(Interval i) {
    lo_[count_] = i.lo;
    hi_[count_++] = i.hi;
  }
  /// Written always and kept if it has lanes: a branch here is one that the processor guesses wrong.
  void doubt(const Doubt& d) {
    doubts_[doubt_count_] = d;
    doubt_count_ += d.lanes != 0;
  }
  std::span<const Doubt> doubts() const { return {doubts_, static_cast<size_t>(doubt_count_)}; }
  void no_more_doubts() { doubt_count_ = 0; }
  bool empty() const { return count_ == 0; }

  /// Takes all of them from the set, whole connected stretches at a time. True if that changed it.
  bool flush(VisibleSet& visible) {
    bool changed = false;
    int first = 0;
    while (first < count_) {
      // Only what meets the visible set counts; what is left of a vector is moved to its front.
      alignas(64) float lows[kWidth], highs[kWidth];
      const int count = std::min(count_ - first, kWidth);
      const S::Floats lo = S::load_unaligned(lo_ + first), hi = S::load_unaligned(hi_ + first);
      const S::Mask meets = S::both(S::mask((1u << count) - 1), visible.meeting(lo, hi));
      S::compress(lows, meets, lo);
      S::compress(highs, meets, hi);
      changed |= take(visible, lows, highs, std::popcount(S::bits(meets)));
      first += count;
    }
    count_ = 0;
    return changed;
  }

 private:
  // Every lane of every block, and the whole vector that a compressed store writes.
  static constexpr int kCapacity = (kBlocks + 1) * kWidth;

  /// Subtracts the connected stretches of a union of intervals.
  static bool take(VisibleSet& visible, const float* lows, const float* highs, int count) {
    if (count < 2) return count == 1 && visible.subtract(lows[0], highs[0]);
    const S::Mask used = S::mask((1u << count) - 1);
    const S::Floats lo = S::select(used, S::load(lows), S::all(2)),
                    hi = S::select(used, S::load(highs), S::all(-1));
    // An end is one of the union's if no other interval holds it and goes on; starts likewise.
    S::Mask inner_end = S::mask(0), inner_start = S::mask(0);
    for (int j = 0; j < count; ++j) {
      const S::Floats l = S::all(lows[j]), h = S::all(highs[j]);
      inner_end = S::either(inner_end, S::both(S::less_equal(l, hi), S::less(hi, h)));
      inner_start = S::either(inner_start, S::both(S::less(l, lo), S::less_equal(lo, h)));
    }
    const S::Mask ends = S::without(used, inner_end);
    bool changed = false;
    for (uint32_t starts = S::bits(S::without(used, inner_start)); starts != 0; starts &= starts - 1) {
      const float start = lows[std::countr_zero(starts)];
      const S::Mask later = S::both(ends, S::less(S::all(start), hi));
      changed |= visible.subtract(start, S::lowest(S::select(later, hi, S::all(2))));
    }
    return changed;
  }

  int count_ = 0, doubt_count_ = 0;
  Doubt doubts_[kBlocks + 1];
  alignas(64) float lo_[kCapacity], hi_[kCapacity];
};

/// The fan's functionals, ready for vectors.
class FanBlock {
  using S = Simd;

 public:
  explicit FanBlock(const LineFan& fan) : fan_(fan) {}

  /// Adds what the block hides within [v0,v1], and the lanes that settle() must look at. True if one of the
  /// stretches is wider than `widest`, which it then becomes.
  bool hidden(const TriangleBlock& block, const Excluded& excluded, float v0, float v1, HiddenIntervals& out,
              float& widest) const {
    Corner c[3];
    for (int i = 0; i < 3; ++i) c[i] = corner(block.p[i]);
    const S::Mask d1 = S::differ(c[0].below, c[1].below), d2 = S::differ(c[0].below, c[2].below);
    S::Mask cut = S::either(d1, d2);
    // The odd vertex out is 0 if it differs from both, else the one that differs from 0.
    const S::Mask odd0 = S::both(d1, d2), odd1 = S::without(d1, d2), odd2 = S::without(d2, d1);
    const auto pick = [&](auto member) {
      return Picked{S::select(odd0, c[0].*member, S::select(odd1, c[1].*member, c[2].*member)),
                    S::select(odd0, c[1].*member, c[0].*member), S::select(odd2, c[1].*member, c[2].*member)};
    };
    const Picked g = pick(&Corner::g), beta = pick(&Corner::beta), t = pick(&Corner::t);
    const Crossings e1 = cross(g.first, beta.first, t.first, g.odd, beta.odd, t.odd);
    const Crossings e2 = cross(g.second, beta.second, t.second, g.odd, beta.odd, t.odd);
    S::Floats v1s = S::div(e1.beta, e1.t), v2s = S::div(e2.beta, e2.t);
    if (excluded.count != 0) cut = S::without(cut, excluded_lanes(block, excluded));
    // Mostly all cuts lie clearly between x and the light.
    const S::Floats nearer = S::min(before(fan_.near, e1), before(fan_.near, e2));
    const S::Floats farther = S::max(before(fan_.light_near, e1), before(fan_.light_near, e2));
    S::Mask clear = S::both(S::less_equal(S::all(0), nearer), S::less(farther, S::all(0)));
    if (S::bits(S::without(cut, clear)) != 0) {
      const Place at1 = place(e1), at2 = place(e2);
      cut = S::without(S::without(cut, S::both(at1.behind, at2.behind)), S::both(at1.beyond, at2.beyond));
      clear = S::either(clear, decide_behind(e1, at1, e2, at2, v1s, v2s));
      out.doubt({&block, candidates(S::without(cut, clear), at1, at2, v1s, v2s, v0, v1),
                 static_cast<uint16_t>(S::bits(odd1)), static_cast<uint16_t>(S::bits(odd2))});
    }
    const S::Floats lo = S::max(S::min(v1s, v2s), S::all(v0)), hi = S::min(S::max(v1s, v2s), S::all(v1));
    cut = S::both(S::both(cut, clear), S::less(lo, hi));
    out.add(cut, lo, hi);
    if (S::bits(S::both(cut, S::less(S::all(widest), S::sub(hi, lo)))) == 0) return false;
    widest = S::highest(S::select(cut, S::sub(hi, lo), S::all(0)));
    return true;
  }

  /// Settles what was left in doubt.
  void settle(HiddenIntervals& found, float v0, float v1) const {
    for (const Doubt& d : found.doubts()) {
      for (uint32_t lanes = d.lanes; lanes != 0; lanes &= lanes - 1) {
        const int lane = std::countr_zero(lanes);
        Vec3f p[3];
        for (int c = 0; c < 3; ++c)
          p[c] = {d.block->p[c][0][lane], d.block->p[c][1][lane], d.block->p[c][2][lane]};
        const int odd = d.odd1 >> lane & 1 ? 1 : d.odd2 >> lane & 1 ? 2 : 0;
        const Interval hidden = hidden_near_ends(fan_, p, odd);
        const Interval clamped{std::max(hidden.lo, v0), std::min(hidden.hi, v1)};
        if (clamped.lo < clamped.hi) found.add(clamped);
      }
    }
    found.no_more_doubts();
  }

 private:
  struct Corner {
    S::Floats g, beta, t;
    S::Mask below;
  };
  struct Picked {
    S::Floats odd, first, second;
  };
  struct Crossings {
    S::Floats beta, t, w;
  };
  /// Where the crossings lie along their rays: none of these is close to x, or to the light.
  struct Place {
    S::Mask front, behind, beyond, clear;  ///< clear: in front, before the light
  };

  Corner corner(const float (&p)[3][kWidth]) const {
    const S::Floats x = S::sub(S::load(p[0]), S::all(fan_.x.x)), y = S::sub(S::load(p[1]), S::all(fan_.x.y)),
                    z = S::sub(S::load(p[2]), S::all(fan_.x.z));
    const auto dot = [&](const Vec3f& n) {
      return S::fma(S::all(n.z), z, S::fma(S::all(n.y), y, S::mul(S::all(n.x), x)));
    };
    const S::Floats g = dot(fan_.g);
    return {S::abs(g), dot(fan_.beta), dot(fan_.t), S::less(g, S::all(0))};
  }

  /// Without a fused multiply-add: the same whichever vertex comes first.
  static Crossings cross(S::Floats g, S::Floats beta, S::Floats t, S::Floats g2, S::Floats beta2,
                         S::Floats t2) {
    return {S::add(S::mul(g, beta2), S::mul(g2, beta)), S::add(S::mul(g, t2), S::mul(g2, t)), S::add(g, g2)};
  }

  /// t - limit w: negative before the limit.
  static S::Floats before(float limit, const Crossings& e) { return S::fma(S::all(-limit), e.w, e.t); }

  Place place(const Crossings& e) const {
    Place at;
    at.front = S::less_equal(S::all(0), before(fan_.near, e));
    at.behind = S::less(before(-fan_.near, e), S::all(0));
    at.beyond = S::less_equal(S::all(0), before(fan_.light_far, e));
    at.clear = S::both(at.front, S::less(before(fan_.light_near, e), S::all(0)));
    return at;
  }

  /// Lanes with one end clearly in front and the other clearly behind: that end goes to ±∞.
  S::Mask decide_behind(const Crossings& e1, const Place& at1, const Crossings& e2, const Place& at2,
                        S::Floats& v1s, S::Floats& v2s) const {
    const S::Floats turn = S::sub(S::mul(e2.beta, e1.t), S::mul(e1.beta, e2.t));
    const S::Floats doubt = S::mul(S::all(fan_.error), S::add(S::add(S::abs(e1.t), S::abs(e2.t)),
                                                              S::add(S::abs(e1.beta), S::abs(e2.beta))));
    const S::Mask sure = S::less(doubt, S::abs(turn)), positive = S::less(S::all(0), turn);
    const S::Mask behind1 = S::both(sure, S::both(at2.clear, at1.behind));
    const S::Mask behind2 = S::both(sure, S::both(at1.clear, at2.behind));
    const S::Floats up = S::all(std::numeric_limits<float>::infinity());
    const S::Floats down = S::all(-std::numeric_limits<float>::infinity());
    v1s = S::select(behind1, S::select(positive, down, up), v1s);
    v2s = S::select(behind2, S::select(positive, up, down), v2s);
    return S::either(behind1, behind2);
  }

  /// Of the lanes left for double precision, those that can matter: where both ends are in front, nothing
  /// outside them is hidden.
  static uint32_t candidates(S::Mask left, const Place& at1, const Place& at2, S::Floats v1s, S::Floats v2s,
                             float v0, float v1) {
    const S::Mask bounded = S::both(at1.front, at2.front);
    const S::Mask meets =
        S::both(S::less(S::min(v1s, v2s), S::all(v1)), S::less(S::all(v0), S::max(v1s, v2s)));
    return S::bits(S::without(left, S::without(bounded, meets)));
  }

  static S::Mask excluded_lanes(const TriangleBlock& block, const Excluded& excluded) {
    return S::in_range(block.id, excluded.first, excluded.count);
  }

  const LineFan& fan_;
};

}  // namespace
}  // namespace penumbra
