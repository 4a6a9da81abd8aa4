#pragma once
// A rectangle seen from x: its solid angle and UFK13's area-preserving parametrisation, in forms that keep
// their digits for slivers, grazing, tiny and enormous rectangles. Derivations: README.md.
// Lengths are in scene units, the frame's origin is x: the rectangle spans [x0, x0+w] × [y0, y0+h] in the
// plane at distance z >= 0, axis 0 along edge u, axis 1 along edge v.
#include <optional>

#include "scenes/math.h"
#include "worker/lights/offset_warp.h"

namespace penumbra {

/// Solid angle (sr) of [x0, x0+w] × [y0, y0+h] at distance z from x; 0 unless all of w, h, z are positive.
double rectangle_solid_angle(double x0, double w, double y0, double h, double z);

/// One chord parallel to an axis.
struct RectangleChord {
  OffsetWarp::Offset offset;  ///< across the chord
  double y0 = 0, length = 0;  ///< along the chord, from the foot of x on its line
  double d2 = 0;              ///< squared distance of x to its line
};

class SphericalRectangle {
 public:
  /// `corner`: minus x. The rectangle is seen only from the side to which u × v points; from behind and
  /// from its own plane the solid angle is 0.
  SphericalRectangle(const Vec3d& corner, const Vec3d& u, const Vec3d& v);

  double solid_angle() const { return omega_; }
  /// Unit normal, along u × v.
  const Vec3d& normal() const { return normal_; }
  /// Length of edge u (axis 0) or v (1).
  double edge_length(int axis) const { return size_[axis]; }

  /// Fractions of u and v, in [0,1], of a point uniform in solid angle. solid_angle() must not be 0.
  Vec2d sample(const Vec2d& u) const;
  /// The inverse of sample().
  Vec2d invert(const Vec2d& fractions) const;
  /// Density of sample() per area at fractions of u and v: z/(r³ Ω).
  double pdf_area(const Vec2d& fractions) const;

  /// A chord parallel to edge u (`along_u`) or v, uniform in solid angle; the one at a fraction of the
  /// other edge; and the density of its offset per length, z (h1 − h0)/(d² Ω).
  RectangleChord chord(bool along_u, double u) const;
  RectangleChord chord_at(bool along_u, double fraction) const;
  double pdf_offset(const RectangleChord& chord) const;

 private:
  /// What an axis' offsets need, made at its first use: most shading points use one axis or none. So an
  /// object belongs to one thread.
  const OffsetWarp& warp(int axis) const;
  RectangleChord chord_with(bool along_u, OffsetWarp::Offset offset) const;

  Vec3d normal_;
  double start_[2], size_[2], z_, omega_;
  mutable std::optional<OffsetWarp> warps_[2];
};

}  // namespace penumbra
