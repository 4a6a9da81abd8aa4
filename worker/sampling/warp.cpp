#include "worker/sampling/warp.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace penumbra {

using std::numbers::pi;

Vec2d square_to_disk_concentric(const Vec2d& u) {
  // Shirley & Chiu 1997: concentric squares become concentric circles.
  const double a = 2 * u.x - 1, b = 2 * u.y - 1;
  if (a == 0 && b == 0) return {0, 0};
  const bool by_a = std::abs(a) > std::abs(b);
  const double r = by_a ? a : b;
  const double phi = by_a ? (pi / 4) * (b / a) : pi / 2 - (pi / 4) * (a / b);
  return {r * std::cos(phi), r * std::sin(phi)};
}

Vec3d square_to_cosine_hemisphere(const Vec2d& u) {
  // Malley: the disk lifted to the hemisphere. The radius may round to a hair above 1.
  const Vec2d d = square_to_disk_concentric(u);
  return {d.x, d.y, std::sqrt(std::max(0.0, 1 - d.x * d.x - d.y * d.y))};
}

double cosine_hemisphere_pdf(double cos_theta) {
  return std::max(0.0, cos_theta) / pi;
}

Vec3d square_to_sphere(const Vec2d& u) {
  const double z = 1 - 2 * u.x, r = 2 * std::sqrt(u.x * (1 - u.x)), phi = 2 * pi * u.y;
  return {r * std::cos(phi), r * std::sin(phi), z};
}

Vec3d square_to_cone(const Vec2d& u, double one_minus_cos_max) {
  // q = 1 − cosθ is uniform; sin²θ = q (2 − q) keeps the digits of narrow cones.
  const double q = u.x * one_minus_cos_max, sin_theta = std::sqrt(q * (2 - q)), phi = 2 * pi * u.y;
  return {sin_theta * std::cos(phi), sin_theta * std::sin(phi), 1 - q};
}

double cone_pdf(double one_minus_cos_max) {
  return one_minus_cos_max > 0 ? 1 / (2 * pi * one_minus_cos_max) : 0;
}

Vec2d square_to_triangle(const Vec2d& u) {
  // Heitz 2019: halves of the square are squeezed to the triangle; less distorted than the square root.
  const double half = 0.5 * std::min(u.x, u.y);
  return u.y > u.x ? Vec2d(half, u.y - half) : Vec2d(u.x - half, half);
}

void frame(const Vec3d& n, Vec3d& s, Vec3d& t) {
  // Duff et al. 2017: Frisvad's frame, mirrored for n.z < 0 so that nothing is divided by 1 + n.z ≈ 0.
  const double sign = std::copysign(1.0, n.z), a = -1 / (sign + n.z), b = n.x * n.y * a;
  s = {1 + sign * n.x * n.x * a, sign * b, -sign * n.x};
  t = {b, sign + n.y * n.y * a, -n.y};
}

}  // namespace penumbra
