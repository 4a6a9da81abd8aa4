#pragma once
// Do samples of a direction follow their density? Pearson's χ² over cells of the sphere.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <optional>
#include <random>
#include <vector>

#include "worker/sampling/warp.h"

namespace penumbra::statistical {

/// Directions about an axis, by (w, φ) in the unit square: tan(θ/2) = spread w/(1-w). Half of the square is
/// within about 2·spread of the axis, so that narrow lobes fill many cells, and all of the sphere is covered.
class PolarMap {
 public:
  PolarMap(const Vec3d& axis, double spread) : axis_(axis), spread_(spread) { frame(axis_, s_, t_); }

  Vec3d direction(double w, double v) const {
    const double r = spread_ * w / (1 - w), phi = 2 * std::numbers::pi * v;
    const double scale = 2 * r / (1 + r * r);
    return s_ * (scale * std::cos(phi)) + t_ * (scale * std::sin(phi)) + axis_ * ((1 - r * r) / (1 + r * r));
  }
  /// dω / (dw dv): sinθ dθ = 4 r dr / (1+r²)².
  double jacobian(double w) const {
    const double r = spread_ * w / (1 - w), d = 1 + r * r;
    return 2 * std::numbers::pi * 4 * r / (d * d) * spread_ / ((1 - w) * (1 - w));
  }
  Vec2d square(const Vec3d& d) const {
    const double x = d ^ s_, y = d ^ t_, z = d ^ axis_;
    // tan(θ/2) = sinθ/(1+cosθ) = (1-cosθ)/sinθ: whichever does not cancel.
    const double sine = std::hypot(x, y), r = z > 0 ? sine / (1 + z) : (1 - z) / sine;
    const double phi = std::atan2(y, x) / (2 * std::numbers::pi);
    return {r / (r + spread_), phi < 0 ? phi + 1 : phi};
  }

 private:
  Vec3d axis_, s_, t_;
  double spread_;
};

using Density = std::function<double(const Vec3d&)>;
using Sampler = std::function<std::optional<Vec3d>(const Vec2d& u, double choice)>;

/// ∫ density over a cell of the map's square, split until a 4×4 Gauss rule agrees with its four parts.
class CellIntegral {
 public:
  CellIntegral(const PolarMap& map, const Density& density) : map_(map), density_(density) {}

  double operator()(double w, double v, double dw, double dv, double tolerance, int depth = 0) const {
    const double whole = rule(w, v, dw, dv);
    double parts = 0;
    for (int k = 0; k < 4; ++k) parts += rule(w + dw / 2 * (k & 1), v + dv / 2 * (k >> 1), dw / 2, dv / 2);
    if (std::abs(parts - whole) <= tolerance || depth == 8) return parts;
    double sum = 0;
    for (int k = 0; k < 4; ++k) {
      sum += (*this)(w + dw / 2 * (k & 1), v + dv / 2 * (k >> 1), dw / 2, dv / 2, tolerance / 2, depth + 1);
    }
    return sum;
  }

 private:
  double rule(double w, double v, double dw, double dv) const {
    constexpr std::array<double, 4> kX = {0.0694318442029737, 0.3300094782075719, 0.6699905217924281,
                                          0.9305681557970263};
    constexpr std::array<double, 4> kW = {0.1739274225687269, 0.3260725774312731, 0.3260725774312731,
                                          0.1739274225687269};
    double sum = 0;
    for (int i = 0; i < 4; ++i) {
      for (int j = 0; j < 4; ++j) {
        const double at = w + dw * kX[i];
        sum += kW[i] * kW[j] * map_.jacobian(at) * density_(map_.direction(at, v + dv * kX[j]));
      }
    }
    return sum * dw * dv;
  }
  const PolarMap& map_;
  const Density& density_;
};

/// P(χ² with k degrees of freedom > x), Wilson & Hilferty 1931.
inline double chi_square_tail(double x, double k) {
  const double z = (std::cbrt(x / k) - (1 - 2 / (9 * k))) / std::sqrt(2 / (9 * k));
  return std::erfc(z / std::numbers::sqrt2) / 2;
}

struct ChiSquare {
  double p_value = 0;
  double total = 0;   ///< ∫ density over the sphere
  double failed = 0;  ///< part of the samples that gave none
};

/// Samples, cells, and the cell of those that failed (probability 1 - ∫ density). Cells that expect fewer
/// than 8 samples are pooled.
inline ChiSquare chi_square(const Sampler& sample, const Density& density, const PolarMap& map, int samples,
                            unsigned seed) {
  constexpr int kW = 24, kV = 24;
  std::vector<double> counts(kW * kV + 1), expected(kW * kV + 1);
  std::mt19937_64 generator(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (int i = 0; i < samples; ++i) {
    const double x = uniform(generator), y = uniform(generator), choice = uniform(generator);
    const std::optional<Vec3d> d = sample({x, y}, choice);
    if (!d) {
      ++counts.back();
      continue;
    }
    const Vec2d at = map.square(*d);
    const int w = std::min(kW - 1, static_cast<int>(at.x * kW)),
              v = std::min(kV - 1, static_cast<int>(at.y * kV));
    ++counts[w * kV + v];
  }
  ChiSquare result;
  const CellIntegral integral(map, density);
  for (int w = 0; w < kW; ++w) {
    for (int v = 0; v < kV; ++v) {
      const double p = integral(double(w) / kW, double(v) / kV, 1.0 / kW, 1.0 / kV, 1e-6);
      expected[w * kV + v] = p * samples;
      result.total += p;
    }
  }
  expected.back() = std::max(0.0, 1 - result.total) * samples;
  result.failed = counts.back() / samples;
  double chi2 = 0, pooled = 0, pooled_counts = 0;
  int cells = 0;
  const auto add = [&](double count, double mean) {
    chi2 += (count - mean) * (count - mean) / mean;
    ++cells;
  };
  for (size_t i = 0; i < counts.size(); ++i) {
    if (expected[i] >= 8) {
      add(counts[i], expected[i]);
    } else {
      pooled += expected[i];
      pooled_counts += counts[i];
    }
  }
  // A pool that expects next to nothing still must not be full: one count per 1e-3 expected is allowed for
  // by the floor of the integration's own error.
  if (pooled > 0 || pooled_counts > 0) add(pooled_counts, std::max(pooled, 0.5));
  result.p_value = cells > 1 ? chi_square_tail(chi2, cells - 1) : 1;
  return result;
}

}  // namespace penumbra::statistical
