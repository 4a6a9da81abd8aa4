#include "worker/geometry/tube.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "worker/geometry/tube_frame.h"

namespace penumbra {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Smallest interval that holds what was added.
struct Hull {
  double lo = kInfinity, hi = -kInfinity;
  void add(double v) {
    lo = std::min(lo, v);
    hi = std::max(hi, v);
  }
};

/// Calls use(v) for the real roots of q2 v² + 2 q1 v + q0, without cancellation (Press et al. 2007, §5.6).
template <class Use>
void roots(double q2, double q1, double q0, Use use) {
  const double discriminant = q1 * q1 - q2 * q0;
  if (!(discriminant >= 0)) return;
  const double k = -(q1 + std::copysign(std::sqrt(discriminant), q1));
  if (q2 != 0) use(k / q2);
  if (k != 0) use(q0 / k);
}

/// A line p + v d, and where it passes nearest to a segment's parts: roots are looked for from there, so that
/// coefficients hold no difference of large squares.
struct Line {
  Vec3d p, d;
  double nearest_to(const Vec3d& point) const { return (point - p).dot(d) / d.length2(); }
};

/// Where a line passes through the surface of a segment: use(v) for every crossing of a ball or the side; the
/// least and the greatest of all v are where it enters and leaves.
template <class Use>
void crossings(const TubeSegment& s, const Line& line, Use use) {
  const double dd = line.d.length2();
  for (const double w : {0., 1.}) {
    const Vec3d centre = s.centre(w);
    const double radius = s.radius(w), v = line.nearest_to(centre);
    const Vec3d q = line.p + line.d * v - centre;
    roots(dd, q.dot(line.d), q.length2() - radius * radius, [&](double dv) { use(v + dv); });
  }
  if (!s.has_side()) return;
  // A point q from the first centre lies on the side of the ball w = (q·e + r dr) / shape, where
  // |q|² - r² - (q·e + r dr)² / shape = 0.
  const double v = line.nearest_to(s.c + s.e * 0.5);
  const Vec3d q = line.p + line.d * v - s.c;
  const double along = q.dot(s.e) + s.r * s.dr, step = line.d.dot(s.e);
  roots(dd - step * step / s.shape, q.dot(line.d) - along * step / s.shape,
        q.length2() - s.r * s.r - along * along / s.shape, [&](double dv) {
          const double w = (along + dv * step) / s.shape;
          if (w >= 0 && w <= 1) use(v + dv);
        });
}

/// F(w) = r(w)² |d|² - |c(w) × d|² = α w² + 2 β w + γ, for rays from the origin along d and centres c
/// relative to it: not negative for balls that the ray's line meets.
struct Met {
  Met(const TubeSegment& s, const Vec3d& c, const Vec3d& d) {
    const Vec3d p = c.cross(d), q = s.e.cross(d);
    const double dd = d.length2();
    alpha = s.dr * s.dr * dd - q.length2();
    beta = s.r * s.dr * dd - p.dot(q);
    gamma = s.r * s.r * dd - p.length2();
  }
  double at(double w) const { return (alpha * w + 2 * beta) * w + gamma; }
  double alpha, beta, gamma;
};

/// What one segment hides of a fan: the hull of the directions in which the fan touches it, in front of the
/// light.
class Hidden {
 public:
  Hidden(const TubeFan& fan, const TubeSegment& s) : fan_(fan), s_(s), c_(s.c - fan.x) {}

  Interval find() {
    if (!cut_by_plane()) return kHidesNothing;
    const double t0 = fan_.t.dot(centre(w_lo_)), t1 = fan_.t.dot(centre(w_hi_));
    const double reach = std::max(s_.radius(w_lo_), s_.radius(w_hi_)) * fan_.t_length;
    const double nearest = std::min(t0, t1) - reach, farthest = std::max(t0, t1) + reach;
    if (farthest <= 0 || nearest >= 1) return kHidesNothing;
    if (nearest <= 0 && holds_x()) return {0, 1};
    // Of thin strands the plane mostly cuts the side alone.
    if (w_lo_ == 0) touch_ball(centre(0), s_.radius(0));
    if (w_hi_ == 1) touch_ball(centre(1), s_.radius(1));
    if (s_.has_side()) touch_side();
    if (nearest <= 0) look_along_chord();
    if (farthest >= 1) crossings(s_, {fan_.x + fan_.a, fan_.chord}, [&](double v) { hull_.add(v); });
    const Interval hidden{static_cast<float>(std::max(hull_.lo, 0.)),
                          static_cast<float>(std::min(hull_.hi, 1.))};
    return hidden.lo < hidden.hi ? hidden : kHidesNothing;
  }

 private:
  Vec3d centre(double w) const { return c_ + s_.e * w; }
  Vec3d direction(double v) const { return fan_.a + fan_.chord * v; }

  /// The balls that the fan's plane cuts: |plane · c(w)| <= r(w), two linear conditions.
  bool cut_by_plane() {
    const double h = fan_.plane.dot(c_), dh = fan_.plane.dot(s_.e);
    for (const double side : {1., -1.}) {
      const double f = side * h - s_.r, df = side * dh - s_.dr;  // f + w df <= 0
      if (df > 0) w_hi_ = std::min(w_hi_, -f / df);
      if (df < 0) w_lo_ = std::max(w_lo_, -f / df);
      if (df == 0 && f > 0) return false;
    }
    return w_lo_ <= w_hi_;
  }

  bool holds_x() const {
    const double w = s_.has_side() ? std::clamp((s_.r * s_.dr - c_.dot(s_.e)) / s_.shape, 0., 1.) : 0;
    for (const double ball : {0., w, 1.})
      if (centre(ball).length2() <= s_.radius(ball) * s_.radius(ball)) return true;
    return false;
  }

  /// A ray along d touches a ball about c at c·d / |d|² of its length; that must be between x and the light.
  void touch(double v, const Vec3d& c) {
    const Vec3d d = direction(v);
    const double along = c.dot(d);
    if (along > 0 && along <= d.length2()) hull_.add(v);
  }

  /// r² |d|² = |c × d|², from where |c × d| is least.
  void touch_ball(const Vec3d& c, double r) {
    const Vec3d slope = c.cross(fan_.chord);
    const double v = start(-c.cross(fan_.a).dot(slope), slope.length2());
    const Vec3d d = direction(v), offset = c.cross(d);
    roots(r * r * fan_.chord.length2() - slope.length2(), r * r * d.dot(fan_.chord) - offset.dot(slope),
          r * r * d.length2() - offset.length2(), [&](double dv) { touch(v + dv, c); });
  }

  // The greatest F(w) is 0 where the ray touches the side. β² - α γ = |d|² (|M × d|² - (n·d)²) with
  // M = dr c - r e and n = c × e (Lagrange's identity, twice), so that is quadratic in v too; roots from
  // where the ray meets the axis' plane, n·d = 0.
  void touch_side() {
    const Vec3d m = c_ * s_.dr - s_.e * s_.r, n = c_.cross(s_.e);
    const double v = start(-n.dot(fan_.a), n.dot(fan_.chord));
    const Vec3d d = direction(v), md = m.cross(d), mc = m.cross(fan_.chord);
    const double nd = n.dot(d), nc = n.dot(fan_.chord);
    roots(mc.length2() - nc * nc, md.dot(mc) - nd * nc, md.length2() - nd * nd, [&](double dv) {
      const Met met(s_, c_, direction(v + dv));
      if (!(met.alpha < 0)) return;
      const double w = -met.beta / met.alpha;
      if (w >= 0 && w <= 1) touch(v + dv, centre(w));
    });
  }

  /// Rays parallel to the chord, which no v reaches: what hides them hides all v beyond some.
  void look_along_chord() {
    for (const double sign : {1., -1.}) {
      const Met met(s_, c_, fan_.chord);
      const double inner = met.alpha < 0 ? std::clamp(-met.beta / met.alpha, 0., 1.) : 0;
      for (const double w : {0., inner, 1.})
        if (met.at(w) >= 0 && sign * centre(w).dot(fan_.chord) > 0) hull_.add(sign * kInfinity);
    }
  }

  /// Where to look for roots from; far away is no better than the chord's own beginning.
  static double start(double numerator, double denominator) {
    const double v = numerator / denominator;
    return std::abs(v) < 0x1p20 ? v : 0;
  }

  const TubeFan& fan_;
  const TubeSegment& s_;
  const Vec3d c_;
  double w_lo_ = 0, w_hi_ = 1;
  Hull hull_;
};

/// n·ê on the side.
double lean_of_side(const TubeSegment& s, double length) {
  return s.has_side() ? -s.dr / length : 0;
}

}  // namespace

TubeFan::TubeFan(const Vec3d& from, const Vec3d& to_a, const Vec3d& to_b)
    : x(from), a(to_a), chord(to_b - to_a), plane(to_a.cross(to_b).normalized()) {
  // -(plane × chord) is at right angles to the chord; its product with a is the chord's distance from x times
  // the chord's length.
  t = chord.cross(plane);
  t *= 1 / t.dot(a);
  t_length = t.length();
}

Interval hidden_by_tube(const TubeFan& fan, const TubeSegment& segment) {
  return Hidden(fan, segment).find();
}

void refine(const TubeSegment& s, const Ray& ray, Hit& hit) {
  const Vec3d origin(ray.origin), d(ray.direction);
  Hull hull;
  crossings(s, {origin, d}, [&](double v) { hull.add(v); });
  double distance = hit.distance;
  // A ray that only single precision sees hit has passed the side within its rounding.
  if (hull.lo <= hull.hi)
    distance = std::abs(hull.lo - distance) <= std::abs(hull.hi - distance) ? hull.lo : hull.hi;
  hit.distance = static_cast<float>(distance);
  const Vec3d q = origin + d * distance - s.c;
  const double side = s.has_side() ? (q.dot(s.e) + s.r * s.dr) / s.shape : (s.dr > 0 ? 1 : 0);
  const double w = std::clamp(side, 0., 1.);
  Vec3d normal = (q - s.e * w).normalized();
  if (normal.length2() == 0) normal = -d.normalized();  // the tip of a cone
  const TubeFrame frame(s.e);
  hit.u = static_cast<float>(w);
  if (w == 0 || w == 1) hit.u += static_cast<float>(normal.dot(frame.axis) - lean_of_side(s, frame.length));
  const double turn = std::atan2(normal.dot(frame.t), normal.dot(frame.s)) / (2 * std::numbers::pi);
  hit.v = static_cast<float>(turn < 0 ? turn + 1 : turn);
}

bool meets(const TubeSegment& s, const Vec3d& x, const Vec3d& y) {
  Hull hull;
  crossings(s, {x, y - x}, [&](double v) { hull.add(v); });
  return hull.lo <= 1 && hull.hi >= 0;
}

TubePoint tube_point(const TubeSegment& s, float u, float v) {
  const TubeFrame frame(s.e);
  TubePoint point;
  point.w = std::clamp(double{u}, 0., 1.);
  const double lean = std::clamp(lean_of_side(s, frame.length) + (u - point.w), -1., 1.);
  const double upright = std::sqrt((1 - lean) * (1 + lean)), turn = 2 * std::numbers::pi * v;
  point.normal = frame.axis * lean + (frame.s * std::cos(turn) + frame.t * std::sin(turn)) * upright;
  return point;
}

}  // namespace penumbra
