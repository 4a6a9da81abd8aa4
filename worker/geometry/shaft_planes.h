#pragma once
// The pyramid of a shaft: its faces with all roundings taken outwards, and the two judgements on a triangle
// that need double precision. Shared by all instruction sets.
#include "worker/geometry/shaft.h"

namespace penumbra {

/// A half-space of points q relative to x: inside where normal·q + offset >= 0. The sum of |normal_k| is 1,
/// so that a computed value below 0 means a distance of more than the slack in `offset`.
struct ShaftFace {
  Vec3f normal;
  float offset = 0;
};

/// In coordinates relative to x. See shaft_planes.cpp for `slack`.
struct ShaftPlanes {
  static constexpr int kMostFaces = 6;  ///< four sides, the light's plane, the horizon

  std::array<ShaftFace, kMostFaces> faces;
  int face_count = 0;
  Vec3f x;
  Vec3d x_exact;
  std::array<Vec3d, 4> corners;  ///< of the light
  std::array<Vec3f, 4> corners_single;
  Vec3f middle;         ///< of the light
  Vec3f lo, hi;         ///< bounds of the pyramid, widened
  double farthest = 0;  ///< distance of the farthest corner
  double height = 0;    ///< of x over the light's plane, less the rounding of chords' ends
  double slack = 0;     ///< a triangle farther than this from the pyramid hides nothing
  bool usable = false;  ///< false: x is behind the light, or too close to its plane to tell

  /// The plane of triangle p keeps it clear of the pyramid, though it may be close to x.
  bool plane_clears(const Vec3f p[3]) const;
  /// The triangle hides all of the light, from every line and every ray.
  bool covered_by(const Vec3f p[3]) const;
};

/// `reach`: no vertex is farther from x than this.
void set_up(ShaftPlanes& planes, const ShaftQuery& query, double reach);

}  // namespace penumbra
