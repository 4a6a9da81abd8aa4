#include "worker/lights/spherical_rectangle.h"

#include <algorithm>
#include <cmath>

#include "worker/lights/chord_measure.h"
#include "worker/lights/plane_distance.h"

namespace penumbra {
namespace {

/// A part of an axis on one side of the foot, mirrored to 0 <= lo <= hi; width = hi − lo, kept apart because
/// the difference of large ends has lost its digits.
struct Part {
  double lo, hi, width;
};

/// Splits [a, a+width] at the foot.
int split_at_foot(double a, double width, Part* parts) {
  const double b = a + width;
  if (a >= 0) {
    parts[0] = {a, b, width};
    return 1;
  }
  if (b <= 0) {
    parts[0] = {-b, -a, width};
    return 1;
  }
  parts[0] = {0, b, b};
  parts[1] = {0, -a, -a};
  return 2;
}

/// A complex number whose argument is half a solid angle. Angles add as factors multiply, so that the whole
/// sum costs one arctangent: while the sum is small all terms are positive and nothing cancels; when it is
/// not, an error relative to the modulus is one relative to the angle.
struct HalfAngle {
  double re = 1, im = 0;
  void add(double other_re, double other_im) {
    const double r = re * other_re - im * other_im;
    im = re * other_im + im * other_re;
    re = r;
  }
  /// Keeps products of up to eight factors far from under- and overflow.
  void normalise() {
    const double scale = 1 / (std::abs(re) + im);
    re *= scale;
    im *= scale;
  }
};

/// Adds the part of a rectangle in one quadrant of the foot.
void add_quadrant(HalfAngle& sum, const Part& x, const Part& y, double z) {
  const double zz = z * z;
  if (x.lo == 0 && y.lo == 0) {
    // A corner at the foot has tan ω = wh/(z r), so tan(ω/2) = wh/(z r + √((z r)²+(wh)²)), and the root's
    // argument is (w²+z²)(h²+z²).
    const double r = std::sqrt(x.hi * x.hi + y.hi * y.hi + zz);
    const double hypotenuse = std::sqrt((x.hi * x.hi + zz) * (y.hi * y.hi + zz));
    sum.add(z * r + hypotenuse, x.width * y.width);
  } else {
    // Two triangles ABC, ACD by Van Oosterom & Strackee 1983; in a quadrant every dot product is positive.
    const double a = std::sqrt(x.lo * x.lo + y.lo * y.lo + zz), b = std::sqrt(x.hi * x.hi + y.lo * y.lo + zz);
    const double c = std::sqrt(x.hi * x.hi + y.hi * y.hi + zz), d = std::sqrt(x.lo * x.lo + y.hi * y.hi + zz);
    const double ab = x.lo * x.hi + y.lo * y.lo + zz, bc = x.hi * x.hi + y.lo * y.hi + zz;
    const double cd = x.lo * x.hi + y.hi * y.hi + zz, da = x.lo * x.lo + y.lo * y.hi + zz;
    const double ac = x.lo * x.hi + y.lo * y.hi + zz, determinant = x.width * y.width * z;
    sum.add(a * b * c + ab * c + bc * a + ac * b, determinant);
    sum.add(a * c * d + ac * d + cd * a + da * c, determinant);
  }
  sum.normalise();
}

/// Solid angle of the half-infinite band [x, ∞) × [y0, y0+h], x >= 0: the limit of a triangle pair whose far
/// corners meet at infinity.
double tail_solid_angle(double x, double y0, double h, double z) {
  Part parts[2];
  const int count = split_at_foot(y0, h, parts);
  HalfAngle sum;
  for (int i = 0; i < count; ++i) {
    const double r0 = std::sqrt(x * x + parts[i].lo * parts[i].lo + z * z);
    const double r1 = std::sqrt(x * x + parts[i].hi * parts[i].hi + z * z);
    sum.add(r0 * r1 + (x * x + parts[i].lo * parts[i].hi + z * z) + x * (r0 + r1), z * parts[i].width);
    sum.normalise();
  }
  return 2 * std::atan2(sum.im, sum.re);
}

}  // namespace

double rectangle_solid_angle(double x0, double w, double y0, double h, double z) {
  const double largest = std::max({std::abs(x0), std::abs(x0 + w), std::abs(y0), std::abs(y0 + h), z});
  if (!(w > 0 && h > 0 && z > 0)) return 0;
  // Triple products of lengths are formed: scaled by a power of two, which rounds nothing.
  int exponent;
  std::frexp(largest, &exponent);
  const double unit = std::ldexp(1.0, -exponent);
  Part xs[2], ys[2];
  const int nx = split_at_foot(x0 * unit, w * unit, xs), ny = split_at_foot(y0 * unit, h * unit, ys);
  HalfAngle sum;
  for (int i = 0; i < nx; ++i)
    for (int j = 0; j < ny; ++j) add_quadrant(sum, xs[i], ys[j], z * unit);
  return 2 * std::atan2(sum.im, sum.re);
}

// The offset's equation: with L and U the solid angles of the infinite band [y0,y1] left and right of the
// offset x, L + U = band, and r1 = √(y1²+z²), x = (r1/2)(ρ − 1/ρ), where
//   ρ² = sin(L/2) sin(β+U/2) / (sin(U/2) sin(β+L/2)),  β = atan2(z, y1).
// UFK13's formula is the same with arc cosines, which lose half the digits. Here L and U are sums of solid
// angles that are positive and known to full relative precision, and x − x0 is expanded so that the small
// difference of two large numbers becomes sin(σ/2), σ = u Ω the strip's solid angle.
OffsetWarp::OffsetWarp(double x0, double w, double y0, double h, double z, double omega)
    : x0_(x0), w_(w), z_(z), omega_(omega), mirrored_(std::abs(x0) > std::abs(x0 + w)) {
  if (mirrored_) x0_ = -(x0 + w);
  double y1 = y0 + h;
  if (y0 + y1 < 0) {
    const double mirrored_y0 = -y1;
    y1 = -y0;
    y0 = mirrored_y0;
  }
  const double x1 = x0_ + w_;
  const double band = 2 * std::atan2(z * h, z * z + y0 * y1);
  const double near = tail_solid_angle(std::abs(x0_), y0, h, z),
               far = tail_solid_angle(std::abs(x1), y0, h, z);
  left_ = x0_ < 0 ? near : band - near;
  right_ = x0_ < 0 ? band - near : near;
  beyond_ = x1 > 0 ? far : band - far;
  top_ = std::atan2(z, y1);
  bottom_ = std::atan2(z, -y0);
  const double r1 = std::sqrt(y1 * y1 + z * z), r = std::sqrt(x0_ * x0_ + r1 * r1);
  rho0_ = x0_ >= 0 ? (x0_ + r) / r1 : r1 / (r - x0_);
  sin_left_ = sin_half(left_, right_);
  sin_right_ = sin_half(right_, left_);
  b0_ = sin_right_ * sin_half_raised(left_, right_);
  const double nearest = std::sqrt(std::max(y0, 0.0) * std::max(y0, 0.0) + z * z);
  foot_inside_and_near_ = x0_ < 0 && x1 > 0 && nearest < std::max(-x0_, x1);
}

// sin(a/2) and sin(β + a/2) for a + b = band. top + bottom + band/2 = π: of an angle and its supplement the
// smaller one is taken, whose sine is accurate relative to itself.
double OffsetWarp::sin_half(double a, double b) const {
  return std::sin(std::min(a / 2, top_ + bottom_ + b / 2));
}
double OffsetWarp::sin_half_raised(double a, double b) const {
  return std::sin(std::min(top_ + a / 2, bottom_ + b / 2));
}

OffsetWarp::Offset OffsetWarp::sample(double u) const {
  if (!mirrored_) return sample_near_end(u);
  const Offset m = sample_near_end(1 - u);
  return {w_ - m.t, -m.x};
}

OffsetWarp::Offset OffsetWarp::sample_near_end(double u) const {
  if (u == 0) return {0, x0_};
  const double sigma = u * omega_, left = left_ + sigma, right = beyond_ + (1 - u) * omega_;
  const double sl = sin_half(left, right), sr = sin_half(right, left);
  const double ql = sin_half_raised(left, right), qr = sin_half_raised(right, left);
  const double a = sl * qr, b = sr * ql, rho = std::sqrt(a / b);
  // With one end on either side of the foot and the foot near, x itself: x = z sin((L−U)/2) / (2√(AB)).
  if (foot_inside_and_near_) {
    const double x =
        std::min(std::max(z_ * std::sin((left - right) / 2) / (2 * std::sqrt(a * b)), x0_), x0_ + w_);
    return {std::min(std::max(x - x0_, 0.0), w_), x};
  }
  const double k = (ql * sin_left_ + qr * sin_right_) / 2;
  const double t = z_ * std::sin(sigma / 2) * k * (1 + 1 / (rho * rho0_)) / (b * b0_ * (rho + rho0_));
  const double inside = std::min(std::max(t, 0.0), w_);  // rounding only
  return {inside, x0_ + inside};
}

SphericalRectangle::SphericalRectangle(const Vec3d& corner, const Vec3d& u, const Vec3d& v) {
  size_[0] = u.length();
  size_[1] = v.length();
  start_[0] = corner.dot(u) / size_[0];
  start_[1] = corner.dot(v) / size_[1];
  z_ = distance_in_front(-corner, u, v);
  omega_ = rectangle_solid_angle(start_[0], size_[0], start_[1], size_[1], z_);
}

const OffsetWarp& SphericalRectangle::warp(int axis) const {
  std::optional<OffsetWarp>& slot = warps_[axis];
  if (!slot) slot.emplace(start_[axis], size_[axis], start_[1 - axis], size_[1 - axis], z_, omega_);
  return *slot;
}

RectangleChord SphericalRectangle::chord_with(bool along_u, OffsetWarp::Offset offset) const {
  const int along = along_u ? 0 : 1;
  return {offset, start_[along], size_[along], offset.x * offset.x + z_ * z_};
}

RectangleChord SphericalRectangle::chord(bool along_u, double u) const {
  return chord_with(along_u, warp(along_u ? 1 : 0).sample(u));
}

RectangleChord SphericalRectangle::chord_at(bool along_u, double fraction) const {
  const int across = along_u ? 1 : 0;
  const double t = fraction * size_[across];
  return chord_with(along_u, {t, start_[across] + t});
}

double SphericalRectangle::pdf_offset(const RectangleChord& chord) const {
  return z_ * height_difference(chord.y0, chord.length, chord.d2) / (chord.d2 * omega_);
}

Vec2d SphericalRectangle::sample(const Vec2d& u) const {
  const RectangleChord c = chord(false, u.x);
  return {c.offset.t / size_[0], sample_height(c.y0, c.length, c.d2, u.y) / size_[1]};
}

Vec2d SphericalRectangle::invert(const Vec2d& fractions) const {
  const RectangleChord c = chord_at(false, fractions.x);
  const double strip = rectangle_solid_angle(start_[0], c.offset.t, start_[1], size_[1], z_);
  return {strip / omega_,
          height_difference(c.y0, fractions.y * c.length, c.d2) / height_difference(c.y0, c.length, c.d2)};
}

double SphericalRectangle::pdf_area(const Vec2d& fractions) const {
  const RectangleChord c = chord_at(false, fractions.x);
  const double y = c.y0 + fractions.y * c.length, r2 = c.d2 + y * y;
  return z_ / (r2 * std::sqrt(r2) * omega_);
}

}  // namespace penumbra
