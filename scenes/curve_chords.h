#pragma once
// A cubic Bézier piece and the chords that stand in for it.
#include <algorithm>
#include <cmath>

#include "scenes/curve.h"

namespace penumbra {

inline Vec3d point_at(const CurvePiece& p, double t) {
  const double s = 1 - t;
  return p[0] * (s * s * s) + p[1] * (3 * s * s * t) + p[2] * (3 * s * t * t) + p[3] * (t * t * t);
}

/// dp/dt; of a piece whose end points coincide there, the direction that it leaves them in.
inline Vec3d tangent_at(const CurvePiece& p, double t) {
  const double s = 1 - t;
  const Vec3d d = (p[1] - p[0]) * (3 * s * s) + (p[2] - p[1]) * (6 * s * t) + (p[3] - p[2]) * (3 * t * t);
  if (d.length2() > 0) return d;
  return t < 0.5 ? p[2] - p[0] : p[3] - p[1];
}

/// Chords of equal steps that stay within `tolerance` of the curve: a chord of step h is at most h²/8 max|p″|
/// away, and |p″| is at most 6 times the larger second difference of the control points.
inline int chords_of(const CurvePiece& p, double tolerance) {
  const double bend = std::max((p[0] - p[1] * 2. + p[2]).length(), (p[1] - p[2] * 2. + p[3]).length());
  const double chords = std::ceil(std::sqrt(6 * bend / (8 * tolerance)));
  return static_cast<int>(std::clamp(chords, 1., static_cast<double>(kMostCurveSegments)));
}

/// From one chord, or cross-section, to the next a curve turns by no more than this: more would be seen as a
/// corner where it is as wide as its bends are. A ribbon's two triangles between two sections then leave the
/// twisted surface by less than a hundredth of its width (1 - cos and half the bulge of a bilinear patch).
constexpr double kMostTurn = 0.125;

/// At least `chords`, and as many more as it takes that the tangents at a chord's ends, if it is longer than
/// `shortest`, differ by kMostTurn at most. With the shortest a tenth of the width that is none where the
/// bends are fifty times wider than the curve, as in hair, and no more than eight times as many at a bend as
/// narrow as the curve.
inline int chords_for_turn(const CurvePiece& p, int chords, double shortest) {
  for (;;) {
    double most = 0;
    for (int i = 0; i < chords; ++i) {
      const double t0 = static_cast<double>(i) / chords, t1 = static_cast<double>(i + 1) / chords;
      if ((point_at(p, t1) - point_at(p, t0)).length() <= shortest) continue;
      const Vec3d a = tangent_at(p, t0), b = tangent_at(p, t1);
      most = std::max(most, std::atan2(a.cross(b).length(), a.dot(b)));
    }
    if (!(most > kMostTurn) || chords == kMostCurveSegments) return chords;
    const double wanted = std::ceil(chords * std::clamp(most / kMostTurn, 1.1, 2.));
    chords = static_cast<int>(std::min(wanted, static_cast<double>(kMostCurveSegments)));
  }
}

/// The longest segment, in radii: what Embree computes in single precision of a side of length L puts r² off
/// by a few u L², which at 256 r is some thousandths of it.
constexpr double kMostSlender = 256;

/// Chords of equal steps no longer than `longest`: |p′| is at most three times the longest leg of the control
/// polygon.
inline int chords_for_length(const CurvePiece& p, double longest) {
  const double leg = std::max({(p[1] - p[0]).length(), (p[2] - p[1]).length(), (p[3] - p[2]).length()});
  return static_cast<int>(
      std::clamp(std::ceil(3 * leg / longest), 1., static_cast<double>(kMostCurveSegments)));
}

}  // namespace penumbra
