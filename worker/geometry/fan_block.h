#pragma once
// What sixteen pairs of triangles hide of a chord: hidden_by_triangle (line_fan.cpp) of both, to the last
// bit.
#include "worker/geometry/hidden_intervals.h"

namespace penumbra {
namespace {

/// The fan's functionals, ready for vectors.
class FanBlock {
  using R = Register;

 public:
  /// Keeps the fan's address.
  void set_up(const LineFan& fan) {
    fan_ = &fan;
    near_ = R::all(fan.near);
    // An edge's crossing is a mean of its corners' t, with three roundings: with all corners this far inside
    // the limits, it lies within them as place() says.
    near_sure_ = fan.near * (1 + 0x1p-20f);
    light_sure_ = fan.light_near * (1 - 0x1p-20f);
    light_past_ = fan.light_far * (1 + 0x1p-20f);
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
  bool hidden(const PairBlock& block, const Excluded& excluded, float v0, float v1, HiddenIntervals& out,
              float& widest) const {
    bool wider = false;
    for (int at = 0; at < block.lanes; at += R::kLanes)
      wider |= part_hidden(block, at, excluded, v0, v1, out, widest);
    return wider;
  }
  /// The same, for blocks of triangles of which most reach behind x or beyond the light.
  bool hidden_by_large(const PairBlock& block, const Excluded& excluded, float v0, float v1,
                       HiddenIntervals& out, float& widest) const {
    bool wider = false;
    for (int at = 0; at < block.lanes; at += R::kLanes)
      wider |= part_in_doubt(block, at, excluded, v0, v1, out, widest);
    return wider;
  }

  /// Settles what was left in doubt.
  void settle(HiddenIntervals& found, float v0, float v1) const {
    for (const Doubt& d : found.doubts()) {
      for (uint32_t lanes = d.lanes; lanes != 0; lanes &= lanes - 1) {
        const int lane = std::countr_zero(lanes), in_block = d.at + lane;
        if (!d.block->has(in_block, d.which)) continue;
        const std::array<Vec3f, 3> p = d.block->triangle(in_block, d.which);
        const Interval hidden =
            hidden_near_ends(*fan_, p.data(), d.block->vertex_of(in_block, d.which, d.odd_corner(lane)));
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

  /// The fan's coordinates of pairs' corners, |g| apart from its sign.
  struct Corners {
    R::Floats g[4], beta[4], t[4];
  };
  /// Lanes in which the fan's plane separates corners 0 and 1, and each triangle's own corner from corner 0;
  /// and those in which it cuts a triangle that is not the light's.
  struct Sides {
    R::Mask shared, to0[2], cut[2];
  };
  /// What the triangles of pairs hide, before it is clamped: from v1 to v2, in any order.
  struct Ends {
    R::Floats v1[2], v2[2];
    R::Mask sure[2];  ///< they hide something, and single precision says what
    R::Mask joined;   ///< both do, and what they hide meets at the shared edge
  };

  [[gnu::always_inline]] void set_corners(const R::Floats q[4][3], Corners& c) const {
    for (int i = 0; i < 4; ++i) {
      c.g[i] = R::abs(c.g[i]);
      c.beta[i] = dot(beta_, q[i]);
      c.t[i] = dot(t_, q[i]);
    }
  }
  [[gnu::always_inline]] Sides sides_of(const PairBlock& block, int at, const Excluded& excluded,
                                        R::Floats q[4][3], Corners& c) const {
    R::Mask below[4];
    for (int i = 0; i < 4; ++i) {
      for (int k = 0; k < 3; ++k) q[i][k] = R::add(minus_x_[k], R::load(block.p[i][k] + at));
      c.g[i] = dot(g_, q[i]);
      below[i] = R::less(c.g[i], R::all(0));
    }
    Sides sides;
    sides.shared = R::differ(below[0], below[1]);
    for (int i = 0; i < 2; ++i) {
      sides.to0[i] = R::differ(below[2 + i], below[0]);
      sides.cut[i] = R::either(sides.shared, sides.to0[i]);
    }
    if (block.may_hold(excluded)) {
      for (int i = 0; i < 2; ++i)
        sides.cut[i] =
            R::without(sides.cut[i], R::in_range(block.id[i] + at, excluded.first, excluded.count));
    }
    return sides;
  }

  /// Lanes [at, at + R::kLanes) of a block.
  [[gnu::always_inline]] bool part_hidden(const PairBlock& block, int at, const Excluded& excluded, float v0,
                                          float v1, HiddenIntervals& out, float& widest) const {
    R::Floats q[4][3];
    Corners c;
    const Sides sides = sides_of(block, at, excluded, q, c);
    const R::Mask cut = R::either(sides.cut[0], sides.cut[1]);
    if (R::bits(cut) == 0) return false;
    set_corners(q, c);
    const R::Floats least = R::min(R::min(c.t[0], c.t[1]), R::min(c.t[2], c.t[3]));
    const R::Floats most = R::max(R::max(c.t[0], c.t[1]), R::max(c.t[2], c.t[3]));
    // All corners clearly behind x, or beyond the light: so is what is cut of them.
    const R::Mask within =
        R::both(cut, R::both(R::less(R::all(-near_sure_), most), R::less(least, R::all(light_past_))));
    // Mostly all lie clearly between x and the light, and what is cut with them.
    const R::Mask between = R::both(R::less(R::all(near_sure_), least), R::less(most, R::all(light_sure_)));
    const uint32_t left = R::bits(within);
    if (left == 0) return false;
    if ((left & ~R::bits(between)) != 0 && !clear_cuts(c, sides, within))
      return part_in_doubt(block, at, excluded, v0, v1, out, widest);
    Ends ends;
    const R::Floats v01 = end(c, 0, 1);
    for (int i = 0; i < 2; ++i) {
      const R::Floats own0 = end(c, 2 + i, 0), own1 = end(c, 2 + i, 1);
      ends.v1[i] = R::select(sides.shared, v01, own1);
      ends.v2[i] = R::select(sides.to0[i], own0, own1);
      ends.sure[i] = R::both(sides.cut[i], within);
    }
    ends.joined = sides.shared;
    return add(ends, v0, v1, out, widest);
  }

  /// The same where corners lie behind x or close to it, or beyond the light: what single precision can say
  /// of that; the rest is left to settle().
  [[gnu::noinline]] bool part_in_doubt(const PairBlock& block, int at, const Excluded& excluded, float v0,
                                       float v1, HiddenIntervals& out, float& widest) const {
    R::Floats q[4][3];
    Corners c;
    const Sides sides = sides_of(block, at, excluded, q, c);
    if (R::bits(R::either(sides.cut[0], sides.cut[1])) == 0) return false;
    set_corners(q, c);
    Ends ends;
    R::Mask clear[2];
    const Crossings e01 = crossing(c, 0, 1);
    for (int i = 0; i < 2; ++i) {
      const Crossings own0 = crossing(c, 2 + i, 0), own1 = crossing(c, 2 + i, 1);
      const Crossings e1 = pick(sides.shared, e01, own1), e2 = pick(sides.to0[i], own0, own1);
      const Place at1 = place(e1), at2 = place(e2);
      ends.v1[i] = R::div(e1.beta, e1.t), ends.v2[i] = R::div(e2.beta, e2.t);
      clear[i] = R::both(at1.clear, at2.clear);
      const R::Mask cut = R::without(R::without(sides.cut[i], R::both(at1.behind, at2.behind)),
                                     R::both(at1.beyond, at2.beyond));
      const R::Mask sure = R::either(clear[i], decide_behind(e1, at1, e2, at2, ends.v1[i], ends.v2[i]));
      ends.sure[i] = R::both(cut, sure);
      const uint32_t left = candidates(R::without(cut, sure), at1, at2, ends.v1[i], ends.v2[i], v0, v1);
      out.doubt({&block, static_cast<uint16_t>(left), static_cast<uint16_t>(R::bits(sides.shared)),
                 static_cast<uint16_t>(R::bits(sides.to0[i])), static_cast<uint8_t>(at),
                 static_cast<uint8_t>(i)});
    }
    ends.joined = R::both(sides.shared, R::both(clear[0], clear[1]));
    return add(ends, v0, v1, out, widest);
  }

  /// Do all cuts lie clearly between x and the light?
  [[gnu::always_inline]] bool clear_cuts(const Corners& c, const Sides& sides, R::Mask within) const {
    const R::Mask clear01 = clear(c, 0, 1);
    uint32_t unclear = 0;
    for (int i = 0; i < 2; ++i) {
      const R::Mask own0 = clear(c, 2 + i, 0), own1 = clear(c, 2 + i, 1);
      const R::Mask both = R::both(one(sides.shared, clear01, own1), one(sides.to0[i], own0, own1));
      unclear |= R::bits(R::without(R::both(sides.cut[i], within), both));
    }
    return unclear == 0;
  }
  /// m ? a : b
  static R::Mask one(R::Mask m, R::Mask a, R::Mask b) { return R::either(R::both(m, a), R::without(b, m)); }
  R::Mask clear(const Corners& c, int i, int j) const {
    const R::Floats t = R::add(R::mul(c.g[i], c.t[j]), R::mul(c.g[j], c.t[i])), w = R::add(c.g[i], c.g[j]);
    return R::both(R::less_equal(R::all(0), R::minus_fma(near_, w, t)),
                   R::less(R::minus_fma(light_near_, w, t), R::all(0)));
  }

  /// v where an edge crosses the plane.
  static R::Floats end(const Corners& c, int i, int j) {
    const R::Floats beta = R::add(R::mul(c.g[i], c.beta[j]), R::mul(c.g[j], c.beta[i]));
    return R::div(beta, R::add(R::mul(c.g[i], c.t[j]), R::mul(c.g[j], c.t[i])));
  }

  /// Adds what is settled: of two triangles that meet one interval.
  [[gnu::always_inline]] static bool add(const Ends& of, float v0, float v1, HiddenIntervals& out,
                                         float& widest) {
    const R::Floats lo0 = R::min(of.v1[0], of.v2[0]), hi0 = R::max(of.v1[0], of.v2[0]);
    const R::Floats lo1 = R::min(of.v1[1], of.v2[1]), hi1 = R::max(of.v1[1], of.v2[1]);
    // Where only one of the triangles hides something, it stands for both.
    R::Floats lo = R::min(R::select(of.sure[0], lo0, lo1), R::select(of.sure[1], lo1, lo0));
    R::Floats hi = R::max(R::select(of.sure[0], hi0, hi1), R::select(of.sure[1], hi1, hi0));
    const R::Mask apart = R::without(R::both(of.sure[0], of.sure[1]), of.joined);
    if (R::bits(apart) != 0) {
      lo = R::select(apart, lo0, lo), hi = R::select(apart, hi0, hi);
      const R::Floats from = R::max(lo1, R::all(v0)), to = R::min(hi1, R::all(v1));
      out.add(R::bits(R::both(apart, R::less(from, to))), from, to);
    }
    lo = R::max(lo, R::all(v0)), hi = R::min(hi, R::all(v1));
    const R::Mask some = R::both(R::either(of.sure[0], of.sure[1]), R::less(lo, hi));
    out.add(R::bits(some), lo, hi);
    const R::Floats length = R::sub(hi, lo);
    if (R::bits(R::both(some, R::less(R::all(widest), length))) == 0) return false;
    widest = R::highest(R::select(some, length, R::all(0)));
    return true;
  }

  static R::Floats dot(const R::Floats n[3], const R::Floats q[3]) {
    return R::fma(n[2], q[2], R::fma(n[1], q[1], R::mul(n[0], q[0])));
  }

  /// Without a fused multiply-add: the same whichever vertex comes first.
  static Crossings crossing(const Corners& c, int i, int j) {
    return {R::add(R::mul(c.g[i], c.beta[j]), R::mul(c.g[j], c.beta[i])),
            R::add(R::mul(c.g[i], c.t[j]), R::mul(c.g[j], c.t[i])), R::add(c.g[i], c.g[j])};
  }

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
  float near_sure_, light_sure_, light_past_;
};

}  // namespace
}  // namespace penumbra
