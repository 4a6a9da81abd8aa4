#pragma once
// A rectangle seen from x: its solid angle and UFK13's area-preserving parametrisation, in forms that keep
// their digits for slivers, grazing, tiny and enormous rectangles. Derivations: README.md.
// Lengths are in scene units, the frame's origin is x: the rectangle spans [x0, x0+w] × [y0, y0+h] in the
// plane at distance z >= 0, axis 0 along edge u, axis 1 along edge v.
#include <optional>

#include "scenes/math.h"

namespace penumbra {

/// Solid angle (sr) of [x0, x0+w] × [y0, y0+h] at distance z from x. 0 if z is 0 and x is not in it.
double rectangle_solid_angle(double x0, double w, double y0, double h, double z);

/// Chooses an offset along one axis, uniform in the solid angle of the strip it sweeps.
class OffsetWarp {
 public:
  /// `omega`: solid angle of the whole, > 0.
  OffsetWarp(double x0, double w, double y0, double h, double z, double omega);

  struct Offset {
    double t;  ///< from the rectangle's edge, in [0,w]
    double x;  ///< from the foot of x: x0 + t, but accurate relative to z where t ends near the foot
  };
  /// The strip [x0, x0+t] has the solid angle u·omega.
  Offset sample(double u) const;

 private:
  Offset sample_near_end(double u) const;

  // The frame after mirroring: |x0| <= |x0+w|, y0 + y1 >= 0.
  double x0_, w_, z_, omega_;
  bool mirrored_;
  double left_, right_, beyond_;  ///< solid angles of the infinite band left of x0, right of x0, right of x1
  double top_, bottom_;           ///< elevations of the plane over the band's two edges
  double rho0_, b0_;
  double sin_left_, sin_right_;  ///< sin_half(left_, right_) and the other way round
  bool foot_inside_and_near_;

  double sin_half(double a, double b) const;
  double sin_half_raised(double a, double b) const;
};

/// One chord parallel to an axis, at `offset` along the other.
struct RectangleChord {
  OffsetWarp::Offset offset;
  double y0 = 0, length = 0;  ///< along the chord, from the foot of x on its line
  double d2 = 0;              ///< squared distance of x to its line
};

class SphericalRectangle {
 public:
  /// `corner`: minus x. The rectangle is seen only from the side to which u × v points; from behind and
  /// from its own plane the solid angle is 0.
  SphericalRectangle(const Vec3d& corner, const Vec3d& u, const Vec3d& v);

  double solid_angle() const { return omega_; }

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

  double start_[2], size_[2], z_, omega_ = 0;
  mutable std::optional<OffsetWarp> warps_[2];
};

}  // namespace penumbra
