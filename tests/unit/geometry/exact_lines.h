#pragma once
// What triangles hide of a chord, in extended precision (64 bits), with a bound for each end of what single
// precision may make of it. The road is another than the product's: ends from determinants of the edge and
// the chord's ends (FORMULAS of the battery, §4) instead of functionals of the vertices.
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "worker/geometry/geometry.h"
#include "worker/geometry/line_fan.h"

namespace penumbra::testing {

using Real = long double;
using Vec3l = Imath::Vec3<Real>;

/// [lo, hi] that is surely, or possibly, hidden.
struct Span {
  Real lo = 0, hi = 0;
};

/// A reference for one chord: every product's answer H must satisfy surely ⊆ H ⊆ possibly.
struct HiddenBounds {
  std::vector<Span> surely, possibly;  ///< any order, may overlap
  int doubtful = 0;  ///< triangles whose combinatorics single precision need not get right: all is possible
};

class ExactChord {
 public:
  explicit ExactChord(const LineQuery& query)
      : x_(query.x), a_(Vec3l(query.a) - x_), b_(Vec3l(query.b) - x_), n_(a_.cross(b_)) {
    t_ = n_.cross(a_ - b_);
    light_ = n_.dot(n_);
    // Magnitudes, for error bounds.
    for (int k = 0; k < 3; ++k) {
      const int i = (k + 1) % 3, j = (k + 2) % 3;
      n_size_[k] = std::abs(a_[i] * b_[j]) + std::abs(a_[j] * b_[i]);
    }
    t_norm_ = std::abs(t_.x) + std::abs(t_.y) + std::abs(t_.z);
    end_distance_ = std::max(largest(a_), largest(b_));
    quick_x_ = Vec3d(query.x);
    quick_n_ = Vec3d(n_);
    quick_size_ = Vec3d(n_size_);
  }

  /// Quick and sure: all of the triangle lies on one side of the fan's plane, so that add() adds nothing.
  bool misses(const Vec3f p[3]) const {
    bool above = true, below = true;
    for (int i = 0; i < 3; ++i) {
      const Vec3d q = Vec3d(p[i]) - quick_x_;
      const double g = quick_n_.dot(q);
      const double magnitude =
          quick_size_.x * std::abs(q.x) + quick_size_.y * std::abs(q.y) + quick_size_.z * std::abs(q.z);
      above &= g > kQuickDoubt * magnitude;
      below &= g < -kQuickDoubt * magnitude;
    }
    return above || below;
  }

  /// Adds what triangle p (scene coordinates) hides.
  void add(const Vec3f p[3], HiddenBounds& bounds) const {
    Vec3l q[3];
    Real g[3];
    for (int i = 0; i < 3; ++i) {
      q[i] = Vec3l(p[i]) - x_;
      g[i] = n_.dot(q[i]);
      Real magnitude = 0;
      for (int k = 0; k < 3; ++k) magnitude += n_size_[k] * std::abs(q[i][k]);
      if (std::abs(g[i]) <= kDoubt * magnitude) return doubt_within(p, bounds);
    }
    const bool side[3] = {g[0] < 0, g[1] < 0, g[2] < 0};
    if (side[0] == side[1] && side[0] == side[2]) return;
    const int odd = side[0] != side[1] && side[0] != side[2] ? 0 : side[0] != side[1] ? 1 : 2;
    End ends[2];
    for (int k = 0; k < 2; ++k) {
      const int other = (odd + 1 + k) % 3;
      if (!classify(q[odd], q[other], g[odd], g[other], ends[k])) return doubt(bounds);
    }
    if ((ends[0].behind && ends[1].behind) || (ends[0].beyond && ends[1].beyond)) return;
    for (End& end : ends)
      if ((end.behind || end.beyond) && !set_by_plane(q, end)) return doubt(bounds);
    append(ends, bounds);
  }

 private:
  /// Roundings of single precision within which a sign may come out either way.
  static constexpr Real kDoubt = 64 * static_cast<Real>(kFloatRoundoff);
  static constexpr double kQuickDoubt = 128 * kFloatRoundoff;  // and double precision's own

  struct End {
    Real v = 0, tolerance = 0;
    bool behind = false, beyond = false;
  };

  /// A triangle of which single precision need not know whether the plane cuts it: it hides nothing beyond
  /// the rays to its corners, if these are in front of x, and nothing at all beyond the light.
  void doubt_within(const Vec3f p[3], HiddenBounds& bounds) const {
    Span v{std::numeric_limits<Real>::infinity(), -std::numeric_limits<Real>::infinity()};
    const Vec3l beta = n_.cross(a_);
    bool beyond = true;
    for (int i = 0; i < 3; ++i) {
      const Vec3l q = Vec3l(p[i]) - x_;
      const Real t = t_.dot(q), unsure = kDoubt * t_norm_ * std::max(largest(q), end_distance_);
      if (t <= 1024 * unsure) return doubt(bounds);
      beyond &= t - light_ > unsure;
      v.lo = std::min(v.lo, beta.dot(q) / t);
      v.hi = std::max(v.hi, beta.dot(q) / t);
    }
    if (beyond) return;
    ++bounds.doubtful;
    constexpr Real kRoom = 0x1p-10L;  // the corners' v are right to that, at 1024 roundings from x
    bounds.possibly.push_back({v.lo - kRoom * (1 + std::abs(v.lo)), v.hi + kRoom * (1 + std::abs(v.hi))});
  }
  static Real largest(const Vec3l& v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); }
  static void doubt(HiddenBounds& bounds) {
    ++bounds.doubtful;
    bounds.possibly.push_back({0, 1});
  }
  /// Σ |derivative| × length of the input vector: the battery's scale of a condition number, an input being
  /// known to a roundoff of its length (a small component of a long vector is not better known).
  static Real effect(const Vec3l& derivative, const Vec3l& input) {
    return (std::abs(derivative.x) + std::abs(derivative.y) + std::abs(derivative.z)) * input.length();
  }
  /// The battery's acceptance: 16 eps (1 + cond).
  static Real tolerance(Real cond) { return 16 * static_cast<Real>(kFloatRoundoff) * (1 + cond); }

  /// Where the edge p→q crosses the fan's plane: false if single precision cannot be asked where along the
  /// rays.
  bool classify(const Vec3l& p, const Vec3l& q, Real gp, Real gq, End& end) const {
    const Real t = (std::abs(gp) * t_.dot(q) + std::abs(gq) * t_.dot(p)) / (std::abs(gp) + std::abs(gq));
    const Real unsure = kDoubt * t_norm_ * std::max({largest(p), largest(q), end_distance_});
    if (std::abs(t) <= unsure || std::abs(t - light_) <= unsure) return false;
    end.behind = t < 0;
    end.beyond = t > light_;
    if (end.behind || end.beyond) return true;
    // v = Da/(Da - Db), D = (p×q)·(chord end); its derivative times the input, over all inputs.
    const Vec3l m = p.cross(q);
    const Real da = m.dot(a_), db = m.dot(b_), difference = da - db;
    const Real by_a = -db / (difference * difference), by_b = da / (difference * difference);
    const Vec3l by_p = by_a * q.cross(a_) + by_b * q.cross(b_),
                by_q = by_a * a_.cross(p) + by_b * b_.cross(p);
    end.v = da / difference;
    end.tolerance =
        tolerance(effect(by_a * m, a_) + effect(by_b * m, b_) + effect(by_p, p) + effect(by_q, q));
    return true;
  }

  /// An end behind x runs off to ±∞; one beyond the light is where the triangle's plane meets the chord's
  /// line.
  bool set_by_plane(const Vec3l q[3], End& end) const {
    const Vec3l u = q[1] - q[0], w = q[2] - q[0], normal = u.cross(w);
    Vec3l size;
    for (int k = 0; k < 3; ++k) {
      const int i = (k + 1) % 3, j = (k + 2) % 3;
      size[k] = std::abs(u[i] * w[j]) + std::abs(u[j] * w[i]);
    }
    const Real na = normal.dot(a_ - q[0]), nb = normal.dot(b_ - q[0]);
    const Real reach = std::max({largest(q[0]), largest(q[1]), largest(q[2]), end_distance_});
    const Real unsure = kDoubt * (size.x + size.y + size.z) * reach;
    if (std::abs(na - nb) <= unsure) return false;
    if (end.behind) {
      const Real h = normal.dot(q[0]);
      if (std::abs(h) <= unsure) return false;
      end.v = std::copysign(std::numeric_limits<Real>::infinity(), h * (nb - na));
      return true;
    }
    const Real difference = na - nb, by_na = -nb / (difference * difference),
               by_nb = na / (difference * difference);
    const auto by_corner = [&](const Vec3l& chord_end, int corner) {
      const Vec3l d = chord_end - q[0], by1 = w.cross(d), by2 = d.cross(u);
      return corner == 1 ? by1 : corner == 2 ? by2 : -(normal + by1 + by2);
    };
    Real cond = effect(by_na * normal, a_) + effect(by_nb * normal, b_);
    for (int i = 0; i < 3; ++i) cond += effect(by_na * by_corner(a_, i) + by_nb * by_corner(b_, i), q[i]);
    end.v = na / difference;
    end.tolerance = tolerance(cond);
    return true;
  }

  static void append(const End ends[2], HiddenBounds& bounds) {
    const End &lower = ends[ends[0].v <= ends[1].v ? 0 : 1], &upper = ends[ends[0].v <= ends[1].v ? 1 : 0];
    const Span inner{std::max<Real>(lower.v + lower.tolerance, 0),
                     std::min<Real>(upper.v - upper.tolerance, 1)};
    if (inner.lo < inner.hi) bounds.surely.push_back(inner);
    const Real reach = std::max(lower.tolerance, upper.tolerance);  // the ends may change places
    const bool thin = upper.v - lower.v <= 2 * reach;
    bounds.possibly.push_back(
        {lower.v - (thin ? reach : lower.tolerance), upper.v + (thin ? reach : upper.tolerance)});
  }

  Vec3l x_, a_, b_, n_, t_, n_size_;
  Real light_, t_norm_, end_distance_;
  Vec3d quick_x_, quick_n_, quick_size_;
};

/// The first place where a product's answer contradicts the bounds: a visible point that surely is hidden, or
/// a hidden one that cannot be. Negative: none.
inline Real contradiction(const IntervalSet& visible, HiddenBounds& bounds) {
  for (const Span& hidden : bounds.surely) {
    for (const Interval& v : visible) {
      const Real lo = std::max<Real>(v.lo, hidden.lo), hi = std::min<Real>(v.hi, hidden.hi);
      if (lo < hi) return lo;
    }
  }
  std::sort(bounds.possibly.begin(), bounds.possibly.end(),
            [](const Span& s, const Span& t) { return s.lo < t.lo; });
  Real at = 0;  // all below is accounted for
  const auto must_be_visible = [&](Real lo, Real hi) {
    return std::any_of(visible.begin(), visible.end(),
                       [&](const Interval& v) { return v.lo <= lo && hi <= v.hi; });
  };
  for (const Span& hidden : bounds.possibly) {
    const Real end = std::min<Real>(hidden.lo, 1);
    if (end > at && !must_be_visible(at, end)) return at;
    at = std::max(at, hidden.hi);
  }
  return at < 1 && !must_be_visible(at, 1) ? at : -1;
}

}  // namespace penumbra::testing
