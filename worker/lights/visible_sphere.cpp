#include "worker/lights/visible_sphere.h"

#include <cmath>
#include <numbers>

#include "worker/sampling/warp.h"

namespace penumbra {

using std::numbers::pi;

VisibleSphere::VisibleSphere(const Vec3d& center, double radius, bool inwards)
    : center_(center), distance_(center.length()), radius_(radius) {
  const bool inside = distance_ < radius_;
  if (inside != inwards || distance_ == radius_) return;
  if (inside) {
    omega_ = 4 * pi;
    return;
  }
  const double sine = radius_ / distance_;
  const double cosine = std::sqrt((distance_ - radius_) * (distance_ + radius_)) / distance_;
  one_minus_cos_ = sine * sine / (1 + cosine);
  omega_ = 2 * pi * one_minus_cos_;
}

Vec3d VisibleSphere::sample_normal(const Vec2d& u) const {
  return distance_ < radius_ ? sample_from_inside(u) : sample_from_outside(u);
}

Vec3d VisibleSphere::sample_from_outside(const Vec2d& u) const {
  // θ at x, α at the centre, both from the axis. With S = sinθ_max = R/d the ray meets the sphere first at
  // d (cosθ − q), q = √(S² − sin²θ), whence (law of sines, and projection onto the ray)
  //   sinα = sinθ (cosθ − q)/S,  cosα = (sin²θ + cosθ q)/S,
  // with q² = cos²θ − cos²θ_max = (1−u)(1−cosθ_max)(cosθ + cosθ_max), a product, and
  // cosθ − q = cos²θ_max/(cosθ + q): neither cancels near the limb or for a sphere that all but touches x.
  const double cos_max = 1 - one_minus_cos_, minus = u.x * one_minus_cos_, cos_theta = 1 - minus;
  const double sin2 = minus * (2 - minus), sine_max = radius_ / distance_;
  const double q = std::sqrt((1 - u.x) * one_minus_cos_ * (cos_theta + cos_max));
  const double cos2_max = (distance_ - radius_) * (distance_ + radius_) / (distance_ * distance_);
  const double sin_alpha = std::sqrt(sin2) * cos2_max / ((cos_theta + q) * sine_max);
  const double cos_alpha = (sin2 + cos_theta * q) / sine_max;
  const Vec3d axis = center_ / -distance_;
  Vec3d s, t;
  frame(axis, s, t);
  const double phi = 2 * pi * u.y;
  return cos_alpha * axis + sin_alpha * (std::cos(phi) * s + std::sin(phi) * t);
}

Vec3d VisibleSphere::sample_from_inside(const Vec2d& u) const {
  // Far root of |t ω − c| = R: t = b + √(b² + (R−d)(R+d)), b = ω·c; with b < 0 its conjugate.
  const Vec3d direction = square_to_sphere(u);
  const double b = direction.dot(center_), k = (radius_ - distance_) * (radius_ + distance_);
  const double root = std::sqrt(b * b + k), t = b >= 0 ? b + root : k / (root - b);
  return (t * direction - center_) / radius_;
}

}  // namespace penumbra
