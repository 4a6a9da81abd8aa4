#pragma once
// One accumulator from pixel to report.
#include <cstdint>

namespace penumbra {

/// Weighted mean and sum of squared deviations of groups of passes. A group's weight is the number of its
/// passes; the groups are independent, so m2 estimates the variance even where samples within a group
/// are stratified.
struct Moments {
  int64_t groups = 0;
  double weight = 0;  ///< passes
  double mean = 0;
  double m2 = 0;  ///< sum of weight * (group mean - mean)^2

  /// One more group; group_weight > 0.
  void add(double group_mean, double group_weight);

  /// Chan, Golub & LeVeque 1979, with weights: for two sets a and b, d = mean_b - mean_a, W = w_a + w_b,
  ///   mean = mean_a + d w_b / W,   m2 = m2_a + m2_b + d² w_a w_b / W.
  /// The result of any split equals the whole to rounding, and is the same bits for the same order of
  /// merges.
  void merge(const Moments& other) {
    if (other.groups == 0) return;
    if (groups == 0) {  // exactly the other, with no rounding
      *this = other;
      return;
    }
    const double total = weight + other.weight;
    const double distance = other.mean - mean;
    const double share = other.weight / total;
    mean += distance * share;
    m2 += other.m2 + distance * distance * weight * share;
    weight = total;
    groups += other.groups;
  }

  /// Variance of `mean`; 0 with fewer than two groups. A group of w passes has variance s²/w, so that
  /// E[m2] = (groups - 1) s², and the mean of W passes has variance s²/W = m2 / ((groups - 1) W).
  double variance_of_mean() const;
};

}  // namespace penumbra
