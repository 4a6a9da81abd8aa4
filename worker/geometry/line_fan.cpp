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

/// Where an edge crosses the fan's plane: β and t there, both times w = |g| + |g'| of the edge's vertices.
struct Crossing {
  float beta, t, w;
};

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
  /// Of the edges from the odd vertex out: to the other vertex of lower, and of higher index.
  Crossing lower_edge(int odd) const { return cross(odd == 0 ? 1 : 0, odd); }
  Crossing higher_edge(int odd) const { return cross(odd == 2 ? 1 : 2, odd); }

 private:
  /// Symmetric in the edge's vertices to the last bit: no fused multiply-add.
  Crossing cross(int i, int o) const {
    return {g[i] * beta[o] + g[o] * beta[i], g[i] * t[o] + g[o] * t[i], g[i] + g[o]};
  }
};

bool in_front(const LineFan& fan, const Crossing& e) {
  return std::fma(-fan.near, e.w, e.t) >= 0;
}
bool behind(const LineFan& fan, const Crossing& e) {
  return std::fma(fan.near, e.w, e.t) < 0;
}
bool before_light(const LineFan& fan, const Crossing& e) {
  return std::fma(-fan.light_near, e.w, e.t) < 0;
}
bool beyond(const LineFan& fan, const Crossing& e) {
  return std::fma(-fan.light_far, e.w, e.t) >= 0;
}

/// An interval's ends in any order, clamped to the chord.
Interval ordered(float v1, float v2) {
  return {std::max(std::min(v1, v2), 0.f), std::min(std::max(v1, v2), 1.f)};
}

/// One end of the hidden interval and where it lies along the rays.
struct End {
  float v;
  bool behind, beyond;
};

/// Decided from the edge's own numbers alone, so that both neighbours decide alike.
End end_of(const LineFan& fan, const Crossing& e, const Vec3d& q, const Vec3d& q_odd) {
  const bool front = in_front(fan, e);
  if (front && before_light(fan, e)) return {e.beta / e.t, false, false};
  if (front && beyond(fan, e)) return {e.beta / e.t, false, true};
  if (behind(fan, e)) return {0, true, false};
  const double g = std::abs(fan.g_exact.dot(q)), g_odd = std::abs(fan.g_exact.dot(q_odd));
  const double t = g * fan.t_exact.dot(q_odd) + g_odd * fan.t_exact.dot(q);
  // What is clearly in front to single precision stays so: an edge in the fan's plane has no t in double. It
  // counts as beyond the light then, and its end stays between the two that single precision knows.
  if (!front && !(t > 0)) return {0, true, false};
  const double beta = g * fan.beta_exact.dot(q_odd) + g_odd * fan.beta_exact.dot(q);
  return {front ? e.beta / e.t : static_cast<float>(beta / t), false, t >= fan.light * (g + g_odd)};
}

/// The light's plane, and where double precision must say what is before it. If it is not known, it is the
/// one that holds the chord and is across the fan, and only the chord's own roundings count, relative to x.
void set_plane(LineFan& fan, const LightPlane& plane, double light, double reach, double unsure) {
  const bool known = plane.normal != Vec3d(0, 0, 0);
  const Vec3d& n = known ? plane.normal : fan.t_exact;
  fan.plane = plane.normal;
  fan.height = std::abs(n.dot(fan.a));
  fan.rounding = known ? plane.rounding : 5 * std::max(rounding_along(n, fan.a), rounding_along(n, fan.b));
  // No vertex is rounded by more; seen from near the light's plane, that is much of the way.
  const Vec3d& x = fan.x_exact;
  const Vec3d far(std::abs(x.x) + reach, std::abs(x.y) + reach, std::abs(x.z) + reach);
  const double coplanar = fan.rounding + rounding_along(fan.plane, far);
  unsure += coplanar < fan.height ? light * (coplanar / fan.height) : light;
  fan.light_near = static_cast<float>(light - unsure);
  fan.light_far = static_cast<float>(light + unsure);
}

/// Does the triangle's plane cut the rays to both ends of the chord beyond the light, or before it by less
/// than the rounding of what they are made of (light_plane.h)? Then the triangle hides nothing. `h`, `a`,
/// `b`: from x to the plane and from the plane to the ends, along its normal: a ray to an end meets it at
/// h/(h + a) of its length.
bool none_before_light(const LineFan& fan, const Vec3f p[3], double h, double a, double b) {
  if (h < 0) h = -h, a = -a, b = -b;
  if (a <= 0 && b <= 0) return true;  // a surface just below x, as every x has one
  double coplanar = 0;
  for (int i = 0; i < 3; ++i) coplanar = std::max(coplanar, rounding_along(fan.plane, Vec3d(p[i])));
  coplanar += fan.rounding;
  return a * fan.height <= coplanar * (h + a) && b * fan.height <= coplanar * (h + b);
}

}  // namespace

void set_up(LineFan& fan, const Vec3d& x, const Vec3d& a, const Vec3d& b, double reach,
            const LightPlane& plane) {
  fan.degenerate = true;
  fan.light_near = fan.light_far = fan.near = fan.error = 0;
  fan.light = fan.height = fan.rounding = fan.slack = 0;
  fan.x = Vec3f(x);
  fan.x_exact = x;
  fan.a = a;
  fan.b = b;
  Vec3d n = a.cross(b);
  const double n_size = largest(n);
  if (!(n_size >= std::numeric_limits<double>::min()) || std::isinf(n_size)) return;
  n *= inverse_power_of_two(n_size);
  const Vec3d chord = a - b;
  Vec3d beta = n.cross(a), t = n.cross(chord);
  const double size = std::max(largest(beta), largest(t));
  if (!(size >= std::numeric_limits<double>::min())) return;
  const double scale = inverse_power_of_two(size);
  beta *= scale;
  t *= scale;
  const double light = t.dot(a);  // = t.dot(b) = |N|²
  if (!(light > 0)) return;

  // |t(q)| carries at most (3 roundings of the products and sums + 1 of t's coefficients + 1 of q) u |t| |q|.
  const double error_per_length = 5 * kFloatRoundoff * (std::abs(t.x) + std::abs(t.y) + std::abs(t.z));
  const double farther_end = std::max(largest(a), largest(b));
  fan.g = Vec3f(fan.g_exact = n);
  fan.beta = Vec3f(fan.beta_exact = beta);
  fan.t = Vec3f(fan.t_exact = t);
  // An occluder hides only what is beyond it: close to the light's line double precision decides. A crossing
  // is a mean of its edge's t, each off by 5 u |t|₁ reach, with three roundings more; a little for these
  // bounds' own.
  const double unsure = 2 * error_per_length * std::max(reach, farther_end);
  fan.light = light;
  set_plane(fan, plane, light, reach, unsure);
  // Near x the error of t and β is not small against t: v could come out with the wrong sign and hide the
  // whole chord (a floor just below x, parallel to the chord, is the common case). Below 2^10 error bounds
  // the edge is evaluated in double; above, v is wrong by at most 2^-10 of an interval end near x.
  fan.near = static_cast<float>(0x1p10 * error_per_length * reach);
  // β and t of a crossing are |g| β + |g'| β' and the like: each factor is off by 5 u |n|₁ reach and
  // 5 u |β|₁ reach at most, over factors of at most |β|₁ reach and |n|₁ reach, four products in all.
  const double norms = std::max(std::abs(beta.x) + std::abs(beta.y) + std::abs(beta.z),
                                std::abs(t.x) + std::abs(t.y) + std::abs(t.z)) *
                       (std::abs(n.x) + std::abs(n.y) + std::abs(n.z));
  fan.error = static_cast<float>(20 * kFloatRoundoff * norms * reach * reach);
  // Where a triangle's cut is computed to lie is off by its functionals' errors over their size: relative to
  // `reach`, a few u / sin(x's angle with the chord), and light / (|t| |a|) is at most that sine's size.
  fan.slack = 64 * kFloatRoundoff * reach * std::max(1., largest(t) * farther_end / light);
  fan.degenerate = false;
}

bool has_area(const Vec3d& a, const Vec3d& b) {
  // With |N| above 2^-20 of the longer side's square, none of make_fan's conditions fails by rounding: N·N
  // comes out within 2^-53 |A-B| |A| / |N| < 2^-31 of itself. Floats' differences neither under- nor
  // overflow.
  const double longer = std::max(largest(a), largest(b));
  if (largest(a.cross(b)) > 0x1p-20 * longer * longer) return true;
  return !make_fan(Vec3d(0, 0, 0), a, b, 0).degenerate;
}

Interval hidden_near_ends(const LineFan& fan, const Vec3f p[3], int odd) {
  Vec3d q[3];
  for (int i = 0; i < 3; ++i) q[i] = Vec3d(p[i]) - fan.x_exact;
  const Vec3d normal = (q[1] - q[0]).cross(q[2] - q[0]);
  const double h = normal.dot(q[0]), a = normal.dot(fan.a) - h, b = normal.dot(fan.b) - h;
  if (none_before_light(fan, p, h, a, b)) return kHidesNothing;
  const Corners corners(fan, p);
  End ends[2] = {end_of(fan, corners.lower_edge(odd), q[odd == 0 ? 1 : 0], q[odd]),
                 end_of(fan, corners.higher_edge(odd), q[odd == 2 ? 1 : 2], q[odd])};
  if ((ends[0].behind && ends[1].behind) || (ends[0].beyond && ends[1].beyond)) return kHidesNothing;
  for (int i = 0; i < 2; ++i) {
    End& end = ends[i];
    if (end.behind) {
      // In the fan's plane the triangle's plane is the line s n·A + r n·B = h; where it passes x's height
      // (t = s+r = 0) it has r = h / (n·B - n·A). The cut runs off to v = ±∞ on that side.
      const double r = h * (b - a);
      if (r == 0) return kHidesNothing;  // the triangle's plane holds x
      end.v = std::copysign(std::numeric_limits<float>::infinity(), static_cast<float>(r > 0 ? 1 : -1));
    } else if (end.beyond) {
      // The cut meets the light's line (t = 1: s = 1-v, r = v) where n·A + v (n·B - n·A) = h; between its
      // own ends, whatever rounding says, unless the other end is behind x.
      const auto v = static_cast<float>(a / (a - b));
      const End& other = ends[1 - i];
      if (!(a != b)) return kHidesNothing;  // parallel to the light's line, and in it
      end.v = other.behind ? v : std::clamp(v, std::min(end.v, other.v), std::max(end.v, other.v));
    }
  }
  return ordered(ends[0].v, ends[1].v);
}

Interval hidden_by_triangle(const LineFan& fan, const Vec3f p[3]) {
  const Corners corners(fan, p);
  const bool differs1 = corners.below[0] != corners.below[1], differs2 = corners.below[0] != corners.below[2];
  if (!differs1 && !differs2) return kHidesNothing;
  const int odd = differs1 && differs2 ? 0 : differs1 ? 1 : 2;
  const Crossing e1 = corners.lower_edge(odd), e2 = corners.higher_edge(odd);
  if ((behind(fan, e1) && behind(fan, e2)) || (beyond(fan, e1) && beyond(fan, e2))) return kHidesNothing;
  const bool front1 = in_front(fan, e1) && before_light(fan, e1),
             front2 = in_front(fan, e2) && before_light(fan, e2);
  if (front1 && front2) return ordered(e1.beta / e1.t, e2.beta / e2.t);
  if ((front1 && behind(fan, e2)) || (front2 && behind(fan, e1))) {
    // The cut passes x at β = (β2 t1 - β1 t2) / (t1 - t2) on its way back: to v = ±∞ by the sign, if that
    // stands out from the errors.
    const float turn = e2.beta * e1.t - e1.beta * e2.t;
    const float doubt =
        fan.error * ((std::abs(e1.t) + std::abs(e2.t)) + (std::abs(e1.beta) + std::abs(e2.beta)));
    if (std::abs(turn) > doubt) {
      const float end = std::copysign(std::numeric_limits<float>::infinity(), front1 ? turn : -turn);
      return ordered(front1 ? e1.beta / e1.t : e2.beta / e2.t, end);
    }
  }
  return hidden_near_ends(fan, p, odd);
}

}  // namespace penumbra
