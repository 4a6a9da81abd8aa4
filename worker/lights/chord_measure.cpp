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

}  // namespace penumbra
