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
  double m2 = 0;      ///< sum of weight * (group mean - mean)^2

  void add(double group_mean, double group_weight);
  /// Chan et al. 1979; the result of any split equals the whole to rounding, and is the same bits for
  /// the same order of merges.
  void merge(const Moments& other);
  /// Variance of `mean`; 0 with fewer than two groups.
  double variance_of_mean() const;
};

}  // namespace penumbra
