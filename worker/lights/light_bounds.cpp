#include "worker/lights/light_bounds.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace penumbra {
namespace {

constexpr double kPi = std::numbers::pi;

double angle_between(const Vec3d& a, const Vec3d& b) {
  return std::atan2(a.cross(b).length(), a.dot(b));
}

void extend(LightBounds& bounds, const Vec3d& p) {
  for (int i = 0; i < 3; ++i) {
    bounds.lo[i] = std::min(bounds.lo[i], p[i]);
    bounds.hi[i] = std::max(bounds.hi[i], p[i]);
  }
}

LightBounds around(const Vec3d& p) {
  LightBounds bounds;
  bounds.lo = bounds.hi = p;
  return bounds;
}

/// cos(a − b) for angles in [0,π] given by cosine and sine, or 1 where a <= b.
double cos_less(double cos_a, double sin_a, double cos_b, double sin_b) {
  return cos_a >= cos_b ? 1 : cos_a * cos_b + sin_a * sin_b;
}
/// sin(a − b), or 0 where a <= b.
double sin_less(double cos_a, double sin_a, double cos_b, double sin_b) {
  return cos_a >= cos_b ? 0 : sin_a * cos_b - cos_a * sin_b;
}
double sine_of(double cosine) {
  return std::sqrt(std::max(0.0, 1 - cosine * cosine));
}

struct ShapeBounds {
  LightBounds operator()(const QuadShape& q) const {
    const Vec3d o(q.o), u(q.u), v(q.v);
    LightBounds b = around(o);
    for (const Vec3d& p : {o + u, o + v, o + u + v}) extend(b, p);
    b.normals = {u.cross(v).normalized(), 1};
    return b;
  }
  LightBounds operator()(const TriangleShape& t) const {
    const Vec3d o(t.p0), u = Vec3d(t.p1) - o, v = Vec3d(t.p2) - o;
    LightBounds b = around(o);
    extend(b, Vec3d(t.p1));
    extend(b, Vec3d(t.p2));
    b.normals = {u.cross(v).normalized(), 1};
    return b;
  }
  LightBounds operator()(const SphereShape& s) const {
    LightBounds b = around(Vec3d(s.center));
    b.lo -= Vec3d(s.radius);
    b.hi += Vec3d(s.radius);
    b.normals.cos_spread = -1;
    return b;
  }
  LightBounds operator()(const DiskShape& d) const {
    LightBounds b = around(Vec3d(d.center));
    const Vec3d n = Vec3d(d.n).normalized();
    const Vec3d half(d.radius * sine_of(n.x), d.radius * sine_of(n.y), d.radius * sine_of(n.z));
    b.lo -= half;
    b.hi += half;
    b.normals = {n, 1};
    return b;
  }
  LightBounds operator()(const CylinderShape& c) const {
    LightBounds b = around(Vec3d(c.base));
    extend(b, Vec3d(c.base) + Vec3d(c.axis));
    b.lo -= Vec3d(c.radius);
    b.hi += Vec3d(c.radius);
    b.normals.cos_spread = -1;
    return b;
  }
};

}  // namespace

double luminance(const Rgb& c) {
  return 0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z;
}

NormalCone join(const NormalCone& a, const NormalCone& b) {
  const NormalCone& wide = a.cos_spread <= b.cos_spread ? a : b;
  const NormalCone& slim = a.cos_spread <= b.cos_spread ? b : a;
  if (wide.cos_spread <= -1) return wide;
  const double wide_angle = std::acos(std::min(wide.cos_spread, 1.0));
  const double slim_angle = std::acos(std::min(slim.cos_spread, 1.0));
  const double between = angle_between(wide.axis, slim.axis);
  if (between + slim_angle <= wide_angle) return wide;
  const double spread = (wide_angle + between + slim_angle) / 2;
  const Vec3d across = wide.axis.cross(slim.axis);
  // Opposite axes have no plane between them; and a cone past π holds everything.
  if (spread >= kPi || !(across.length2() > 0)) return {wide.axis, -1};
  const double turn = spread - wide_angle;
  const Vec3d side = across.cross(wide.axis).normalized();
  // Wider by the rounding of the arc cosine near 1, the square root of that of its argument.
  constexpr double kSlack = 4 * 0x1p-26;
  return {(wide.axis * std::cos(turn) + side * std::sin(turn)).normalized(),
          std::cos(std::min(spread + kSlack, kPi))};
}

LightBounds join(const LightBounds& a, const LightBounds& b) {
  LightBounds sum = a;
  extend(sum, b.lo);
  extend(sum, b.hi);
  sum.normals = join(a.normals, b.normals);
  sum.cos_emission = std::min(a.cos_emission, b.cos_emission);
  sum.power = a.power + b.power;
  return sum;
}

LightBounds bounds_of(const AreaEmitter& emitter) {
  LightBounds b = std::visit(ShapeBounds{}, emitter.shape);
  b.power = luminance(emitter.radiance) * area(emitter.shape);
  return b;
}

LightBounds bounds_of(const PointEmitter& emitter) {
  LightBounds b = around(Vec3d(emitter.position));
  b.normals.cos_spread = -1;
  b.power = luminance(emitter.intensity);
  return b;
}

LightBounds bounds_of(const SpotEmitter& emitter) {
  LightBounds b = around(Vec3d(emitter.position));
  b.normals = {Vec3d(emitter.axis), 1};
  // Its edge is where the intensity reaches 0, in single precision.
  b.cos_emission = std::max(-1.0, emitter.cos_outer - 4.0 * std::numeric_limits<float>::epsilon());
  b.power = luminance(emitter.intensity);
  return b;
}

double importance(const LightBounds& b, const Receiver& receiver) {
  const Vec3d centre = 0.5 * (b.lo + b.hi), to_light = centre - receiver.x;
  const double radius2 = 0.25 * (b.hi - b.lo).length2(), d2 = to_light.length2();
  // The sphere about the box, seen from x: half its opening angle, and the distance.
  const bool inside = !(d2 > radius2);
  const double distance2 = std::max(d2, radius2);
  if (!(distance2 > 0)) return b.power;  // on a point light
  if (inside) return b.power / distance2;
  const double sin2_b = radius2 / d2, sin_b = std::sqrt(sin2_b), cos_b = std::sqrt(1 - sin2_b);
  const Vec3d direction = to_light / std::sqrt(d2);

  double cos_receiver = 1;
  if (receiver.has_horizon) {
    const double c = direction.dot(receiver.normal);
    cos_receiver = cos_less(c, direction.cross(receiver.normal).length(), cos_b, sin_b);
    if (!(cos_receiver > 0)) return 0;
  }
  double cos_light = 1;
  if (b.normals.cos_spread > -1) {
    const double c = -direction.dot(b.normals.axis), s = direction.cross(b.normals.axis).length();
    const double cos_o = b.normals.cos_spread, sin_o = sine_of(cos_o);
    // The angle to the axis, less the normals' spread, less the box's opening.
    const double cos_x = cos_less(c, s, cos_o, sin_o), sin_x = sin_less(c, s, cos_o, sin_o);
    const double cos_t = cos_less(cos_x, sin_x, cos_b, sin_b);
    if (!(cos_t > b.cos_emission)) return 0;
    // A surface loses its projected area; a spot light is bright as far as it reaches.
    if (b.cos_emission == 0) cos_light = cos_t;
  }
  return b.power * cos_receiver * cos_light / distance2;
}

}  // namespace penumbra
