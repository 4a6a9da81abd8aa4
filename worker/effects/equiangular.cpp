#include "worker/effects/equiangular.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace penumbra {

Equiangular::Equiangular(const MediumRay& ray, const Vec3d& pivot) : t0_(ray.t0), t1_(ray.t1) {
  const Vec3d to_pivot = pivot - ray.o;
  first_ = ray.t0 - to_pivot.dot(ray.d);
  height_ = to_pivot.cross(ray.d).length();
  // The angle from (first, height) to (last, height) by cross and dot: short parts keep their digits.
  if (std::isinf(t1_))
    angle_ = std::atan2(height_, first_);
  else
    angle_ = std::atan2(height_ * (t1_ - t0_), height_ * height_ + first_ * (first_ + (t1_ - t0_)));
}

double Equiangular::sample(double u) const {
  const double sine = std::sin(u * angle_), cosine = std::cos(u * angle_);
  // The ray at that angle from the first direction meets the line at t0 + r0² sinφ / (h cosφ - first sinφ).
  const double past = height_ * cosine - first_ * sine;
  const double along = (height_ * height_ + first_ * first_) * sine;
  // Rounding may turn the last direction parallel to the line: then the point is the last one.
  const double t = past > 0 ? t0_ + along / past : t1_;
  return std::clamp(t, t0_, std::min(t1_, std::numeric_limits<double>::max()));
}

double Equiangular::pdf(double t) const {
  const double off = first_ + (t - t0_), r2 = height_ * height_ + off * off;
  return r2 > 0 && std::isfinite(r2) ? height_ / (angle_ * r2) : 0;
}

}  // namespace penumbra
