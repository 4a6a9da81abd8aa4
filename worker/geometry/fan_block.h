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
  uint16_t lanes;       ///< counted from `at`, as are the next
  uint16_t odd1, odd2;  ///< lanes whose odd vertex is 1, or 2
  uint16_t at;          ///< first lane of the register
};

/// Hidden intervals that wait to be taken from the visible set, of at most kBlocks blocks.
class HiddenIntervals {
  using R = Register;

 public:
  static constexpr int kBlocks = 2 * kWidth;  // the leaves of two nodes

  void add(uint32_t chosen, R::Floats lo, R::Floats hi) {
    R::compress(lo_ + count_, lo, hi_ + count_, hi, chosen);
    count_ += std::popcount(chosen);
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
    for (int first = 0; first < count_; first += R::kLanes) {
      const R::Floats lo = R::load_unaligned(lo_ + first), hi = R::load_unaligned(hi_ + first);
      const R::Mask meets = R::both(R::first(count_ - first), visible.meeting(lo, hi));
      if (R::bits(meets) == 0) continue;
      changed |= take(visible, R::select(meets, lo, R::all(kNoLo)), R::select(meets, hi, R::all(kNoHi)));
    }
    count_ = 0;
    return changed;
  }

 private:
  // Every lane of every block, and the whole vector that a compressed store writes.
  static constexpr int kCapacity = (kBlocks + 1) * kWidth;

  /// Subtracts the connected stretches of a union of intervals.
  static bool take(VisibleSet& visible, R::Floats lo, R::Floats hi) {
    alignas(64) float lows[R::kLanes], highs[R::kLanes];
    R::store(lows, lo);
    R::store(highs, hi);
    // An end is one of the union's if no other interval holds it and goes on.
    R::Mask inner = R::less(hi, R::all(0));
    for (int j = 0; j < R::kLanes; ++j)
      inner = R::either(inner, R::both(R::less_equal(R::all(lows[j]), hi), R::less(hi, R::all(highs[j]))));
    const uint32_t last = R::bits(inner) ^ ((1u << R::kLanes) - 1);
    if ((last & (last - 1)) == 0) return visible.subtract(R::lowest(lo), highs[std::countr_zero(last)]);
    const R::Floats ends = R::select(inner, R::all(kNoLo), hi);
    // Stretch by stretch: what starts behind one's end belongs to the next.
    bool changed = false;
    for (float start = R::lowest(lo); start < kNoLo;) {
      const float end = R::lowest(R::select(R::less(R::all(start), ends), ends, R::all(kNoLo)));
      changed |= visible.subtract(start, end);
      start = R::lowest(R::select(R::less(R::all(end), lo), lo, R::all(kNoLo)));
    }
    return changed;
  }

  // What a lane without an interval holds.
  static constexpr float kNoLo = 2, kNoHi = -1;

  int count_ = 0, doubt_count_ = 0;
  Doubt doubts_[kBlocks * kWidth / Register::kLanes + 1];
  alignas(64) float lo_[kCapacity], hi_[kCapacity];
};

/// The fan's functionals, ready for vectors.
class FanBlock {
  using R = Register;

 public:
  /// Keeps the fan's address.
  void set_up(const LineFan& fan) {
    fan_ = &fan;
    near_ = R::all(fan.near);
    light_near_ = R::all(fan.light_near);
    light_far_ = R::all(fan.light_far);
    for (int k = 0; k < 3; ++k) {
      minus_x_[k] = R::all(-fan.x[k]);
      g_[k] = R::all(fan.g[k]);
      beta_[k] = R::all(fan.beta[k]);
      t_[k] = R::all(fan.t[k]);
    }
  }

  /// Adds what the block hides within [v0,v1], and the lanes that settle() must look at. True if one of the
  /// stretches is wider than `widest`, which it then becomes.
  bool hidden(const TriangleBlock& block, const Excluded& excluded, float v0, float v1, HiddenIntervals& out,
              float& widest) const {
    bool wider = false;
    for (int at = 0; at < kWidth; at += R::kLanes)
      wider |= part_hidden(block, at, excluded, v0, v1, out, widest);
    return wider;
  }

  /// Settles what was left in doubt.
  void settle(HiddenIntervals& found, float v0, float v1) const {
    for (const Doubt& d : found.doubts()) {
      for (uint32_t lanes = d.lanes; lanes != 0; lanes &= lanes - 1) {
        const int lane = d.at + std::countr_zero(lanes);
        Vec3f p[3];
        for (int c = 0; c < 3; ++c)
          p[c] = {d.block->p[c][0][lane], d.block->p[c][1][lane], d.block->p[c][2][lane]};
        const int odd = d.odd1 >> (lane - d.at) & 1 ? 1 : d.odd2 >> (lane - d.at) & 1 ? 2 : 0;
        const Interval hidden = hidden_near_ends(*fan_, p, odd);
        const Interval clamped{std::max(hidden.lo, v0), std::min(hidden.hi, v1)};
        if (clamped.lo < clamped.hi) found.add(clamped);
      }
    }
    found.no_more_doubts();
  }

 private:
  /// An edge's crossing; β and t times w.
  struct Crossings {
    R::Floats beta, t, w;
  };
  /// Where the crossings lie along their rays: none of these is close to x, or to the light.
  struct Place {
    R::Mask front, behind, beyond, clear;  ///< clear: in front, before the light
  };

  /// Lanes [at, at + R::kLanes) of a block.
  [[gnu::always_inline]] bool part_hidden(const TriangleBlock& block, int at, const Excluded& excluded,
                                          float v0, float v1, HiddenIntervals& out, float& widest) const {
    R::Floats q[3][3], g[3], beta[3], t[3];
    R::Mask below[3];
    for (int c = 0; c < 3; ++c) {
      for (int k = 0; k < 3; ++k) q[c][k] = R::add(minus_x_[k], R::load(block.p[c][k] + at));
      g[c] = dot(g_, q[c]);
      below[c] = R::less(g[c], R::all(0));
    }
    const R::Mask d1 = R::differ(below[0], below[1]), d2 = R::differ(below[0], below[2]);
    R::Mask cut = R::either(d1, d2);
    if (excluded.count != 0)
      cut = R::without(cut, R::in_range(block.id + at, excluded.first, excluded.count));
    if (R::bits(cut) == 0) return false;
    // The odd vertex out is 0 if it differs from both, else the one that differs from 0.
    const R::Mask odd0 = R::both(d1, d2), odd2 = R::without(d2, d1);
    for (int c = 0; c < 3; ++c) {
      g[c] = R::abs(g[c]);
      beta[c] = dot(beta_, q[c]);
      t[c] = dot(t_, q[c]);
    }
    const auto cross = [&](int i, int j) { return crossing(g[i], beta[i], t[i], g[j], beta[j], t[j]); };
    const Crossings e01 = cross(0, 1), e02 = cross(0, 2), e12 = cross(1, 2);
    // From the odd vertex to the other one of lower, and of higher index.
    const Crossings e1 = pick(odd2, e02, e01), e2 = pick(odd0, e02, e12);
    R::Floats v1s = R::div(e1.beta, e1.t), v2s = R::div(e2.beta, e2.t);
    // Mostly all cuts lie clearly between x and the light.
    const R::Floats nearer = R::min(before(near_, e1), before(near_, e2));
    const R::Floats farther = R::max(before(light_near_, e1), before(light_near_, e2));
    R::Mask clear = R::both(R::less_equal(R::all(0), nearer), R::less(farther, R::all(0)));
    if (R::bits(R::without(cut, clear)) != 0) {
      const Place at1 = place(e1), at2 = place(e2);
      cut = R::without(R::without(cut, R::both(at1.behind, at2.behind)), R::both(at1.beyond, at2.beyond));
      clear = R::either(clear, decide_behind(e1, at1, e2, at2, v1s, v2s));
      out.doubt({&block,
                 static_cast<uint16_t>(candidates(R::without(cut, clear), at1, at2, v1s, v2s, v0, v1)),
                 static_cast<uint16_t>(R::bits(R::without(d1, d2))), static_cast<uint16_t>(R::bits(odd2)),
                 static_cast<uint16_t>(at)});
    }
    const R::Floats lo = R::max(R::min(v1s, v2s), R::all(v0)), hi = R::min(R::max(v1s, v2s), R::all(v1));
    cut = R::both(R::both(cut, clear), R::less(lo, hi));
    out.add(R::bits(cut), lo, hi);
    const R::Floats length = R::sub(hi, lo);
    if (R::bits(R::both(cut, R::less(R::all(widest), length))) == 0) return false;
    widest = R::highest(R::select(cut, length, R::all(0)));
    return true;
  }

  static R::Floats dot(const R::Floats n[3], const R::Floats q[3]) {
    return R::fma(n[2], q[2], R::fma(n[1], q[1], R::mul(n[0], q[0])));
  }

  /// Without a fused multiply-add: the same whichever vertex comes first.
  static Crossings crossing(R::Floats g, R::Floats beta, R::Floats t, R::Floats g2, R::Floats beta2,
                            R::Floats t2) {
    return {R::add(R::mul(g, beta2), R::mul(g2, beta)), R::add(R::mul(g, t2), R::mul(g2, t)), R::add(g, g2)};
  }

  /// m ? a : b
  static Crossings pick(R::Mask m, const Crossings& a, const Crossings& b) {
    return {R::select(m, a.beta, b.beta), R::select(m, a.t, b.t), R::select(m, a.w, b.w)};
  }

  /// t - limit w: negative before the limit.
  static R::Floats before(R::Floats limit, const Crossings& e) { return R::minus_fma(limit, e.w, e.t); }

  Place place(const Crossings& e) const {
    Place at;
    at.front = R::less_equal(R::all(0), before(near_, e));
    at.behind = R::less(R::fma(near_, e.w, e.t), R::all(0));
    at.beyond = R::less_equal(R::all(0), before(light_far_, e));
    at.clear = R::both(at.front, R::less(before(light_near_, e), R::all(0)));
    return at;
  }

  /// Lanes with one end clearly in front and the other clearly behind: that end goes to ±∞.
  R::Mask decide_behind(const Crossings& e1, const Place& at1, const Crossings& e2, const Place& at2,
                        R::Floats& v1s, R::Floats& v2s) const {
    const R::Floats turn = R::sub(R::mul(e2.beta, e1.t), R::mul(e1.beta, e2.t));
    const R::Floats doubt = R::mul(R::all(fan_->error), R::add(R::add(R::abs(e1.t), R::abs(e2.t)),
                                                               R::add(R::abs(e1.beta), R::abs(e2.beta))));
    const R::Mask sure = R::less(doubt, R::abs(turn)), positive = R::less(R::all(0), turn);
    const R::Mask behind1 = R::both(sure, R::both(at2.clear, at1.behind));
    const R::Mask behind2 = R::both(sure, R::both(at1.clear, at2.behind));
    const R::Floats up = R::all(std::numeric_limits<float>::infinity());
    const R::Floats down = R::all(-std::numeric_limits<float>::infinity());
    v1s = R::select(behind1, R::select(positive, down, up), v1s);
    v2s = R::select(behind2, R::select(positive, up, down), v2s);
    return R::either(behind1, behind2);
  }

  /// Of the lanes left for double precision, those that can matter: where both ends are in front, nothing
  /// outside them is hidden.
  static uint32_t candidates(R::Mask left, const Place& at1, const Place& at2, R::Floats v1s, R::Floats v2s,
                             float v0, float v1) {
    const R::Mask bounded = R::both(at1.front, at2.front);
    const R::Mask meets =
        R::both(R::less(R::min(v1s, v2s), R::all(v1)), R::less(R::all(v0), R::max(v1s, v2s)));
    return R::bits(R::without(left, R::without(bounded, meets)));
  }

  const LineFan* fan_;
  R::Floats minus_x_[3], g_[3], beta_[3], t_[3], near_, light_near_, light_far_;
};

}  // namespace
}  // namespace penumbra
