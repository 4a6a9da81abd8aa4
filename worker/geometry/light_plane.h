#pragma once
// The plane of a flat light, and what lies before it: one rule for shadow segments, lines and visible areas.
//
// How far before the light counts as before? Vertices are rounded to single precision, each coordinate by at
// most u of itself, and a point inside a triangle is off by no more than its vertices; along the light's
// normal that is u Σ|n_k| |v_k|, for the surface and for the light. The light's points lie on corner + edges,
// the edges rounded from differences: another u Σ|n_k| (extent_u + extent_v)_k. Two surfaces that the scene
// has in one plane are no farther apart than the sum, and neither hides the other; whatever is farther before
// the light than that hides it.
#include <algorithm>
#include <cmath>

#include "scenes/math.h"

namespace penumbra {

/// Unit roundoff of binary32.
constexpr double kFloatRoundoff = 0x1p-24;

struct LightPlane {
  Vec3d normal{0, 0, 0};  ///< unit, of either sense; 0: not known
  double rounding = 0;    ///< by which the light's points may be off their plane (Geometry::place_of)
};

/// u Σ|n_k| |p_k|: what the rounding of a vertex may be along n.
inline double rounding_along(const Vec3d& n, const Vec3d& p) {
  return kFloatRoundoff * (std::abs(n.x * p.x) + std::abs(n.y * p.y) + std::abs(n.z * p.z));
}

}  // namespace penumbra
