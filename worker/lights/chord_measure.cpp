#include "worker/lights/chord_measure.h"

#include <algorithm>
#include <cmath>

namespace penumbra {

double height_difference(double y0, double length, double d2) {
  const double y1 = y0 + length;
  const double r0 = std::sqrt(d2 + y0 * y0), r1 = std::sqrt(d2 + y1 * y1);
  // Both ends on one side of the foot: y1/r1 − y0/r0 cancels, but its numerator y1 r0 − y0 r1 is, multiplied
  // by its conjugate, d² (y1² − y0²) = d² length (y0 + y1).
  if (y0 * y1 > 0) return d2 / (r0 * r1) * length * ((y0 + y1) / (y1 * r0 + y0 * r1));
  return y1 / r1 - y0 / r0;
}

namespace {

// 1 − h and 1 + h, given c = √(1 − h²), each without the cancellation near h = ±1.
double one_minus(double h, double c) {
  return h > 0 ? c * c / (1 + h) : 1 - h;
}
double one_plus(double h, double c) {
  return h < 0 ? c * c / (1 - h) : 1 + h;
}

}  // namespace

double sample_height(double y0, double length, double d2, double v) {
  if (v == 0) return 0;
  const double y1 = y0 + length, d = std::sqrt(d2);
  const double r0 = std::sqrt(d2 + y0 * y0), r1 = std::sqrt(d2 + y1 * y1);
  const double h0 = y0 / r0, h1 = y1 / r1, c0 = d / r0, c1 = d / r1;
  // Both 1 − h and 1 + h are linear in v and interpolated apart, so that whichever is small keeps its digits.
  const double minus = (1 - v) * one_minus(h0, c0) + v * one_minus(h1, c1);
  const double plus = (1 - v) * one_plus(h0, c0) + v * one_plus(h1, c1);
  const double c = std::sqrt(minus * plus), step = v * height_difference(y0, length, d2);
  const double h = minus < 0.5 ? 1 - minus : plus < 0.5 ? plus - 1 : h0 + step;
  // y = d h/c. On one side of the foot, h/c − h0/c0 = (h² − h0²) / (c c0 (h c0 + h0 c)).
  const double t = h * h0 > 0 ? d * step * ((h + h0) / (c * c0 * (h * c0 + h0 * c))) : d * (h / c - h0 / c0);
  return std::min(std::max(t, 0.0), length);  // rounding only: t is in [0,length] for v in [0,1]
}

namespace {

/// Angle at x between the points at t and t + step of a line at distance d.
double angle_between(double t, double step, double d) {
  return std::atan2(d * step, d * d + t * (t + step));
}

}  // namespace

double versine_difference(double t0, double d, double near, double far) {
  const double first = angle_between(t0, near, d), half = 0.5 * angle_between(t0 + near, far - near, d);
  return 2 * std::sin(first + half) * std::sin(half);
}

double sample_versine(double t0, double d, double near, double far, double v) {
  // 1 − cosθ = 2 sin²(θ/2) interpolates; θ = 0 is t0, and t − t0 = r² sinθ / (d cosθ − t0 sinθ), r² = d² +
  // t0².
  const double half = 0.5 * angle_between(t0, near, d), base = 2 * std::sin(half) * std::sin(half);
  const double versine = base + v * versine_difference(t0, d, near, far);
  const double sin_half = std::sqrt(std::min(0.5 * versine, 1.0));
  const double sine = 2 * sin_half * std::sqrt(1 - sin_half * sin_half), cosine = 1 - 2 * sin_half * sin_half;
  const double t = (d * d + t0 * t0) * sine / (d * cosine - t0 * sine);
  return std::min(std::max(t, near), far);  // rounding only
}

}  // namespace penumbra
