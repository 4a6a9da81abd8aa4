#include "worker/geometry/line_fan.h"

#include <bit>
#include <cmath>

namespace penumbra {
namespace {

double largest(const Vec3d& v) {
  return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

/// 1 / 2^floor(log2 m) for a positive normal m: multiplying by it rounds nothing.
double inverse_power_of_two(double m) {
  const uint64_t exponent = std::bit_cast<uint64_t>(m) >> 52;
  return std::bit_cast<double>((2046 - exponent) << 52);
}

float dot_fma(const Vec3f& c, const Vec3f& q) {
  return std::fma(c.z, q.z, std::fma(c.y, q.y, c.x * q.x));
}

/// Where an edge of a triangle crosses the plane, in homogeneous fan coordinates: β and t, both times
/// w = |g_p| + |g_o|. Symmetric in the edge's vertices to the last bit: no fused multiply-add.
template <class Real>
struct Crossing {
  Real beta, t, w;
};

template <class Real>
Crossing<Real> crossing(Real g_p, Real beta_p, Real t_p, Real g_o, Real beta_o, Real t_o) {
  return {g_p * beta_o + g_o * beta_p, g_p * t_o + g_o * t_p, g_p + g_o};
}

/// The single-precision coordinates of a triangle's vertices, |g| and its side apart.
struct Corners {
  float g[3], beta[3], t[3];
  bool below[3];

  Corners(const LineFan& fan, const Vec3f p[3]) {
    for (int i = 0; i < 3; ++i) {
      const Vec3f q = p[i] - fan.x;
      const float side = dot_fma(fan.g, q);
      below[i] = side < 0;  // a vertex in the plane counts as above: coplanar triangles drop out
      g[i] = std::abs(side);
      beta[i] = dot_fma(fan.beta, q);
      t[i] = dot_fma(fan.t, q);
    }
  }
  Crossing<float> cross(int i, int o) const { return crossing(g[i], beta[i], t[i], g[o], beta[o], t[o]); }
};

/// One end of the hidden interval and where it lies along the rays.
struct End {
  float v;
  bool behind, beyond;
};

/// Decided from the edge's own numbers alone, so that both neighbours decide alike.
End end_of(const LineFan& fan, const Corners& corners, const Vec3d q[3], int i, int o) {
  const Crossing<float> c = corners.cross(i, o);
  if (c.t >= fan.near * c.w) return {c.beta / c.t, false, c.t >= fan.light * c.w};
  if (c.t < -fan.near * c.w) return {0, true, false};
  const auto exact =
      crossing(std::abs(fan.g_exact.dot(q[i])), fan.beta_exact.dot(q[i]), fan.t_exact.dot(q[i]),
               std::abs(fan.g_exact.dot(q[o])), fan.beta_exact.dot(q[o]), fan.t_exact.dot(q[o]));
  if (!(exact.t > 0)) return {0, true, false};
  return {static_cast<float>(exact.beta / exact.t), false, c.t >= fan.light * c.w};
}

}  // namespace

LineFan make_fan(const Vec3d& x, const Vec3d& a, const Vec3d& b, double reach) {
  LineFan fan;
  fan.x = Vec3f(x);
  fan.x_exact = x;
  fan.a = a;
  fan.b = b;
  Vec3d n = a.cross(b);
  const double n_size = largest(n);
  if (!(n_size >= std::numeric_limits<double>::min()) || std::isinf(n_size)) return fan;
  n *= inverse_power_of_two(n_size);
  const Vec3d chord = a - b;
  Vec3d beta = n.cross(a), t = n.cross(chord);
  const double size = std::max(largest(beta), largest(t));
  if (!(size >= std::numeric_limits<double>::min())) return fan;
  const double scale = inverse_power_of_two(size);
  beta *= scale;
  t *= scale;
  const double light = t.dot(a);  // = t.dot(b) = |N|²
  if (!(light > 0)) return fan;

  // |t(q)| carries at most (3 roundings of the products and sums + 1 of t's coefficients + 1 of q) u |t| |q|.
  const double error_per_length = 5 * kFloatRoundoff * (std::abs(t.x) + std::abs(t.y) + std::abs(t.z));
  const double farther_end = std::max(largest(a), largest(b));
  fan.g = Vec3f(fan.g_exact = n);
  fan.beta = Vec3f(fan.beta_exact = beta);
  fan.t = Vec3f(fan.t_exact = t);
  // An occluder hides only what is beyond it: one in the light's own line must not win by a rounding.
  fan.light = static_cast<float>(light - error_per_length * farther_end);
  // Near x the error of t and β is not small against t: v could come out with the wrong sign and hide the
  // whole chord (a floor just below x, parallel to the chord, is the common case). Below 2^10 error bounds
  // the edge is evaluated in double; above, v is wrong by at most 2^-10 of an interval end near x.
  fan.near = static_cast<float>(0x1p10 * error_per_length * reach);
  // Where a triangle's cut is computed to lie is off by its functionals' errors over their size: relative to
  // `reach`, a few u / sin(x's angle with the chord), and light / (|t| |a|) is at most that sine's size.
  fan.slack = 64 * kFloatRoundoff * reach * std::max(1., largest(t) * farther_end / light);
  fan.degenerate = false;
  return fan;
}

Interval hidden_near_ends(const LineFan& fan, const Vec3f p[3], int odd) {
  const Corners corners(fan, p);
  const int i1 = odd == 0 ? 1 : 0, i2 = odd == 2 ? 1 : 2;
  Vec3d q[3];
  for (int i = 0; i < 3; ++i) q[i] = Vec3d(p[i]) - fan.x_exact;
  End e1 = end_of(fan, corners, q, i1, odd), e2 = end_of(fan, corners, q, i2, odd);
  if ((e1.behind && e2.behind) || (e1.beyond && e2.beyond)) return kHidesNothing;
  if (e1.behind || e2.behind || e1.beyond || e2.beyond) {
    const Vec3d normal = (q[1] - q[0]).cross(q[2] - q[0]);
    const double h = normal.dot(q[0]), n_a = normal.dot(fan.a), n_b = normal.dot(fan.b);
    for (End* e : {&e1, &e2}) {
      if (e->behind) {
        // In the fan's plane the triangle's plane is the line s n_a + r n_b = h; where it passes x's height
        // (t = s+r = 0) it has r = h / (n_b - n_a). The cut runs off to v = ±∞ on that side.
        const double r = h * (n_b - n_a);
        if (r == 0) return kHidesNothing;  // the triangle's plane holds x
        e->v = std::copysign(std::numeric_limits<float>::infinity(), static_cast<float>(r > 0 ? 1 : -1));
      } else if (e->beyond) {
        // The cut meets the light's line (t = 1: s = 1-v, r = v) where n_a + v (n_b - n_a) = h.
        e->v = static_cast<float>((h - n_a) / (n_b - n_a));
        if (std::isnan(e->v)) return kHidesNothing;  // parallel to the light's line, and in it
      }
    }
  }
  return ordered(e1.v, e2.v);
}

Interval hidden_by_triangle(const LineFan& fan, const Vec3f p[3]) {
  const Corners corners(fan, p);
  const bool o1 = corners.below[0] != corners.below[1], o2 = corners.below[0] != corners.below[2];
  if (!o1 && !o2) return kHidesNothing;
  const int odd = o1 && o2 ? 0 : o1 ? 1 : 2;
  const Crossing<float> c1 = corners.cross(odd == 0 ? 1 : 0, odd), c2 = corners.cross(odd == 2 ? 1 : 2, odd);
  const float near1 = fan.near * c1.w, near2 = fan.near * c2.w;
  if (c1.t < -near1 && c2.t < -near2) return kHidesNothing;
  const bool beyond1 = c1.t >= fan.light * c1.w, beyond2 = c2.t >= fan.light * c2.w;
  if (beyond1 && beyond2) return kHidesNothing;
  if (c1.t < near1 || c2.t < near2 || beyond1 || beyond2) return hidden_near_ends(fan, p, odd);
  return ordered(c1.beta / c1.t, c2.beta / c2.t);
}

}  // namespace penumbra
