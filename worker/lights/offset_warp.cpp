#include "worker/lights/offset_warp.h"

#include <algorithm>
#include <cmath>

#include "worker/lights/axis_parts.h"

namespace penumbra {
namespace {

/// Half the solid angle of the half-infinite band [x, ∞) × [y0, y0+h], x >= 0: of a triangle pair (Van
/// Oosterom & Strackee 1983) whose far corners meet at infinity.
HalfAngle tail(double x, double y0, double h, double z) {
  const AxisParts ys(y0, h);
  HalfAngle sum;
  for (const AxisPart& y : ys) {
    const double r0 = std::sqrt(x * x + y.lo * y.lo + z * z), r1 = std::sqrt(x * x + y.hi * y.hi + z * z);
    sum = sum * HalfAngle{r0 * r1 + (x * x + y.lo * y.hi + z * z) + x * (r0 + r1), z * y.width}.unit();
  }
  return sum;
}

}  // namespace

// The offset's equation: with L and U the solid angles of the infinite band [y0,y1] left and right of the
// offset x, L + U = band, and r1 = √(y1²+z²), x = (r1/2)(ρ − 1/ρ), where
//   ρ² = sin(L/2) sin(β+U/2) / (sin(U/2) sin(β+L/2)),  tanβ = z/y1.
// UFK13's formula is the same with arc cosines, which lose half the digits. Here L and U are sums of solid
// angles that are positive and known to full relative precision, and x − x0 is expanded so that the small
// difference of two large numbers becomes sin(σ/2), σ = uΩ the strip's solid angle.
OffsetWarp::OffsetWarp(double x0, double w, double y0, double h, double z, double omega)
    : x0_(x0), w_(w), z_(z), half_omega_(omega / 2), mirrored_(std::abs(x0) > std::abs(x0 + w)) {
  if (mirrored_) x0_ = -(x0 + w);
  const double x1 = x0_ + w;
  const double low = y0 + (y0 + h) < 0 ? -(y0 + h) : y0, high = low + h;
  const HalfAngle band = HalfAngle{z * z + low * high, z * h}.unit();
  const HalfAngle near = tail(std::abs(x0_), low, h, z), far = tail(std::abs(x1), low, h, z);
  left_ = x0_ < 0 ? near : band * near.conjugate();
  beyond_ = x1 > 0 ? far : band * far.conjugate();
  top_ = HalfAngle{high, z}.unit();
  bottom_ = HalfAngle{-low, z}.unit();

  const double r1 = std::sqrt(high * high + z * z), r = std::sqrt(x0_ * x0_ + r1 * r1);
  rho0_ = x0_ >= 0 ? (x0_ + r) / r1 : r1 / (r - x0_);
  const HalfAngle right = x0_ < 0 ? band * near.conjugate() : near;
  sin_left_ = sin_half(left_, right);
  sin_right_ = sin_half(right, left_);
  b0_ = sin_right_ * sin_half_raised(left_, right);
  const double nearest = std::sqrt(std::max(low, 0.0) * std::max(low, 0.0) + z * z);
  foot_is_near_ = x0_ < 0 && x1 > 0 && nearest < std::max(-x0_, x1);
}

// sin(a/2) and sin(β + a/2) where a + b is the band. top + bottom + band/2 = π: of an angle and its
// supplement the smaller is taken, whose parts are positive sums.
double OffsetWarp::sin_half(const HalfAngle& a, const HalfAngle& b) const {
  return a.re >= 0 ? a.im : (top_ * bottom_ * b).im;
}
double OffsetWarp::sin_half_raised(const HalfAngle& a, const HalfAngle& b) const {
  const HalfAngle raised = top_ * a;
  return raised.re >= 0 ? raised.im : (bottom_ * b).im;
}

OffsetWarp::Offset OffsetWarp::sample(double u) const {
  if (!mirrored_) return sample_from_near_end(u);
  const Offset m = sample_from_near_end(1 - u);
  return {w_ - m.t, -m.x};
}

OffsetWarp::Offset OffsetWarp::sample_from_near_end(double u) const {
  if (u == 0) return {0, x0_};
  const HalfAngle strip = from_angle(u * half_omega_), rest = from_angle((1 - u) * half_omega_);
  const HalfAngle left = left_ * strip, right = beyond_ * rest;
  const double sl = sin_half(left, right), sr = sin_half(right, left);
  const double ql = sin_half_raised(left, right), qr = sin_half_raised(right, left);
  const double a = sl * qr, b = sr * ql;
  // With one end on either side of the foot and the foot near, x itself: x = z sin((L−U)/2) / (2√(AB)). The
  // bounds here and below are met but for rounding.
  if (foot_is_near_) {
    const double x = z_ * (left * right.conjugate()).im / (2 * std::sqrt(a * b));
    const double inside = std::min(std::max(x, x0_), x0_ + w_);
    return {std::min(std::max(inside - x0_, 0.0), w_), inside};
  }
  const double rho = std::sqrt(a / b), k = (ql * sin_left_ + qr * sin_right_) / 2;
  const double t = z_ * strip.im * k * (1 + 1 / (rho * rho0_)) / (b * b0_ * (rho + rho0_));
  const double inside = std::min(std::max(t, 0.0), w_);
  return {inside, x0_ + inside};
}

}  // namespace penumbra
