#include "worker/lights/spherical_rectangle.h"

#include <cmath>

#include "worker/lights/axis_parts.h"
#include "worker/lights/chord_measure.h"
#include "worker/lights/plane_side.h"

namespace penumbra {
namespace {

/// Half the solid angle of a part of the rectangle in one quadrant of the foot.
HalfAngle quadrant(const AxisPart& x, const AxisPart& y, double z) {
  const double zz = z * z;
  if (x.lo == 0 && y.lo == 0) {
    // A corner at the foot has tan ω = wh/(z r), so tan(ω/2) = wh/(z r + √((z r)²+(wh)²)), and the root's
    // argument is (w²+z²)(h²+z²).
    const double r = std::sqrt(x.hi * x.hi + y.hi * y.hi + zz);
    const double hypotenuse = std::sqrt((x.hi * x.hi + zz) * (y.hi * y.hi + zz));
    return {z * r + hypotenuse, x.width * y.width};
  }
  // Two triangles ABC, ACD by Van Oosterom & Strackee 1983; in a quadrant every dot product is positive.
  const double a = std::sqrt(x.lo * x.lo + y.lo * y.lo + zz), b = std::sqrt(x.hi * x.hi + y.lo * y.lo + zz);
  const double c = std::sqrt(x.hi * x.hi + y.hi * y.hi + zz), d = std::sqrt(x.lo * x.lo + y.hi * y.hi + zz);
  const double ab = x.lo * x.hi + y.lo * y.lo + zz, bc = x.hi * x.hi + y.lo * y.hi + zz;
  const double cd = x.lo * x.hi + y.hi * y.hi + zz, da = x.lo * x.lo + y.lo * y.hi + zz;
  const double ac = x.lo * x.hi + y.lo * y.hi + zz, determinant = x.width * y.width * z;
  const HalfAngle first{a * b * c + ab * c + bc * a + ac * b, determinant};
  const HalfAngle second{a * c * d + ac * d + cd * a + da * c, determinant};
  return first * second;
}

}  // namespace

double rectangle_solid_angle(double x0, double w, double y0, double h, double z) {
  if (!(w > 0 && h > 0 && z > 0)) return 0;
  // Lengths of single-precision scenes: products of six of them are far inside the range of a double.
  HalfAngle sum;
  for (const AxisPart& x : AxisParts(x0, w))
    for (const AxisPart& y : AxisParts(y0, h)) sum = sum * quadrant(x, y, z).scaled();
  return sum.whole_angle();
}

SphericalRectangle::SphericalRectangle(const Vec3d& corner, const Vec3d& u, const Vec3d& v) {
  const PlaneSide side = side_of_plane(-corner, u, v);
  normal_ = side.normal;
  z_ = side.distance;
  size_[0] = u.length();
  size_[1] = v.length();
  start_[0] = corner.dot(u) / size_[0];
  start_[1] = corner.dot(v) / size_[1];
  omega_ = rectangle_solid_angle(start_[0], size_[0], start_[1], size_[1], z_);
}

const OffsetWarp& SphericalRectangle::warp(int axis) const {
  std::optional<OffsetWarp>& slot = warps_[axis];
  if (!slot) slot.emplace(start_[axis], size_[axis], start_[1 - axis], size_[1 - axis], z_, omega_);
  return *slot;
}

RectangleChord SphericalRectangle::chord_with(bool along_u, OffsetWarp::Offset offset) const {
  const int along = along_u ? 0 : 1;
  return {offset, start_[along], size_[along], offset.x * offset.x + z_ * z_};
}

RectangleChord SphericalRectangle::chord(bool along_u, double u) const {
  return chord_with(along_u, warp(along_u ? 1 : 0).sample(u));
}

RectangleChord SphericalRectangle::chord_at(bool along_u, double fraction) const {
  const int across = along_u ? 1 : 0;
  const double t = fraction * size_[across];
  return chord_with(along_u, {t, start_[across] + t});
}

double SphericalRectangle::pdf_offset(const RectangleChord& chord) const {
  return z_ * height_difference(chord.y0, chord.length, chord.d2) / (chord.d2 * omega_);
}

Vec2d SphericalRectangle::sample(const Vec2d& u) const {
  const RectangleChord c = chord(false, u.x);
  return {c.offset.t / size_[0], sample_height(c.y0, c.length, c.d2, u.y) / size_[1]};
}

Vec2d SphericalRectangle::invert(const Vec2d& fractions) const {
  const RectangleChord c = chord_at(false, fractions.x);
  const double strip = rectangle_solid_angle(start_[0], c.offset.t, start_[1], size_[1], z_);
  return {strip / omega_,
          height_difference(c.y0, fractions.y * c.length, c.d2) / height_difference(c.y0, c.length, c.d2)};
}

double SphericalRectangle::pdf_area(const Vec2d& fractions) const {
  const RectangleChord c = chord_at(false, fractions.x);
  const double y = c.y0 + fractions.y * c.length, r2 = c.d2 + y * y;
  return z_ / (r2 * std::sqrt(r2) * omega_);
}

}  // namespace penumbra
