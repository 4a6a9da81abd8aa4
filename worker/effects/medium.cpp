#include "worker/effects/medium.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace penumbra {
namespace {

double transmittance(double sigma, double column) {
  return sigma > 0 ? std::exp(-sigma * column) : 1;  // 0 × ∞ is no optical depth
}

}  // namespace

Vec3d transmittance(const Medium& medium, double column) {
  return {transmittance(medium.sigma_t.x, column), transmittance(medium.sigma_t.y, column),
          transmittance(medium.sigma_t.z, column)};
}

FreeFlight::FreeFlight(const Medium& medium, const MediumRay& ray)
    : medium_(medium), ray_(ray), column_(penumbra::column(medium.density, ray)) {
  for (int c = 0; c < 3; ++c) channels_ += medium.sigma_s[c] > 0;
}

ScatterPoint FreeFlight::sample(double u, double choice) const {
  int rest = std::min(int(choice * channels_), channels_ - 1), c = 0;
  while (!(medium_.sigma_s[c] > 0) || rest-- > 0) ++c;
  // Inverts (1 - e^-σs)/(1 - e^-σS), with S the whole column: in e^x - 1 and log(1 + x) a thin medium, where
  // this is s = uS, keeps its digits.
  const double sigma = medium_.sigma_t[c];
  ScatterPoint at;
  at.column = std::min(-std::log1p(u * std::expm1(-sigma * column_)) / sigma, column_);
  at.t = distance_at(medium_.density, ray_, at.column);
  at.density = density_at(medium_.density, ray_.o + ray_.d * at.t);
  return at;
}

double FreeFlight::pdf(const ScatterPoint& at) const {
  double sum = 0;
  for (int c = 0; c < 3; ++c) {
    if (!(medium_.sigma_s[c] > 0)) continue;
    const double sigma = medium_.sigma_t[c], scattered = -std::expm1(-sigma * column_);
    // An optical depth that has vanished in rounding: uniform in the column, its limit.
    sum += scattered > 0 ? sigma * std::exp(-sigma * at.column) / scattered : 1 / column_;
  }
  return sum * at.density / channels_;
}

ScatterPoint FreeFlight::point(double t) const {
  MediumRay before = ray_;
  before.t1 = t;
  return {t, penumbra::column(medium_.density, before), density_at(medium_.density, ray_.o + ray_.d * t)};
}

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
