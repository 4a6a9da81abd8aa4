#pragma once
// What the tests of samplers share: fixed random numbers, χ² and means with their errors, Jacobians.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "worker/sampling/hash.h"
#include "worker/sampling/sampler.h"

namespace penumbra::statistical {

/// Reproducible uniform numbers: the i-th point of a stream.
inline Vec2d random_square(uint64_t stream, uint64_t i) {
  const uint64_t bits = child_key(mix64(stream), i);
  return {uniform(bits), uniform(mix64(bits))};
}

/// Pearson's χ² against cell probabilities, as standard deviations from its mean (Wilson & Hilferty 1931).
/// Cells that expect fewer than five are pooled. A hit in a cell of probability 0 is infinitely unlikely.
inline double chi_square_sigmas(const std::vector<int>& hits, const std::vector<double>& probability) {
  double total = 0;
  for (const int n : hits) total += n;
  double chi2 = 0, pooled_hits = 0, pooled_expected = 0;
  int cells = 0;
  const auto add = [&](double n, double expected) {
    chi2 += (n - expected) * (n - expected) / expected;
    ++cells;
  };
  for (size_t i = 0; i < hits.size(); ++i) {
    const double expected = probability[i] * total;
    if (expected >= 5) {
      add(hits[i], expected);
    } else {
      pooled_hits += hits[i];
      pooled_expected += expected;
    }
  }
  if (pooled_expected >= 5) add(pooled_hits, pooled_expected);
  if (pooled_expected == 0 && pooled_hits > 0) return INFINITY;
  const double k = std::max(1, cells - 1), spread = 2 / (9 * k);
  return (std::cbrt(chi2 / k) - (1 - spread)) / std::sqrt(spread);
}

/// Mean of samples and how far it is from `expected`, in standard errors of the mean.
class MeanTest {
 public:
  void add(double value) {
    ++n_;
    const double delta = value - mean_;
    mean_ += delta / n_;
    m2_ += delta * (value - mean_);
  }
  double mean() const { return mean_; }
  double error() const { return std::sqrt(m2_ / n_ / (n_ - 1)); }
  double sigmas(double expected) const { return (mean_ - expected) / error(); }

 private:
  double n_ = 0, mean_ = 0, m2_ = 0;
};

/// |∂ω/∂u × ∂ω/∂v| of a map from the unit square to points, as directions from x: central differences with
/// one step of Richardson's extrapolation. `point(u)`: the point minus x.
template <class Point>
double direction_jacobian(const Point& point, const Vec2d& u, double h = 2e-4) {
  const auto difference = [&](const Vec2d& step) -> Vec3d {
    const auto central = [&](double scale) {
      const Vec3d forward = point(u + step * scale), back = point(u - step * scale);
      return (forward.normalized() - back.normalized()) / (2 * h * scale);
    };
    return (4.0 * central(0.5) - central(1)) / 3.0;
  };
  return difference({h, 0}).cross(difference({0, h})).length();
}

}  // namespace penumbra::statistical
