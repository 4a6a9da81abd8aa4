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

}  // namespace penumbra
