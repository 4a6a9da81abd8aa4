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

}  // namespace penumbra
