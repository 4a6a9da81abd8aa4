#pragma once
// Half solid angles as arguments of complex numbers: angles add where numbers multiply, sines and cosines are
// read off, and a single arctangent ends a whole sum. While the sum is below π/2 all parts are positive and
// nothing cancels; above, an error relative to the modulus is one relative to the angle.
#include <cmath>

namespace penumbra {

struct HalfAngle {
  double re = 1, im = 0;

  HalfAngle operator*(const HalfAngle& o) const { return {re * o.re - im * o.im, re * o.im + im * o.re}; }
  HalfAngle conjugate() const { return {re, -im}; }

  /// Modulus 1: re and im are cosine and sine.
  HalfAngle unit() const {
    const double inverse = 1 / std::sqrt(re * re + im * im);
    return {re * inverse, im * inverse};
  }
  /// Modulus about 1, for products of many factors.
  HalfAngle scaled() const {
    const double inverse = 1 / (std::abs(re) + std::abs(im));
    return {re * inverse, im * inverse};
  }
  /// Twice the argument.
  double whole_angle() const { return 2 * std::atan2(im, re); }
};

inline HalfAngle from_angle(double half) {
  return {std::cos(half), std::sin(half)};
}

}  // namespace penumbra
