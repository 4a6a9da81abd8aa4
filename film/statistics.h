#pragma once
// The statistics behind every error figure and every statistical test.
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "film/film_image.h"

namespace penumbra {

struct ConfidenceInterval {
  double low = 0, high = 0;
  bool operator==(const ConfidenceInterval&) const = default;
};

/// z with P(Z <= z) = p for a standard normal Z; p in (0,1).
double normal_quantile(double p);
/// P(Z > z); accurate relative to itself far into the tail.
double normal_tail(double z);
/// t with P(T <= t) = p for Student's t; p in (0,1), degrees of freedom > 0 (need not be whole).
double t_quantile(double p, double degrees_of_freedom);
/// P(T > t).
double t_tail(double t, double degrees_of_freedom);

/// Level of each of n independent tests so that the chance of any false alarm is alpha:
/// 1 - (1 - alpha)^(1/n) (Šidák 1967).
double sidak(double alpha, int64_t n);

/// Edge of the blocks over which tests and resampling work, pixels: large enough that a block's mean is
/// near normal, small enough to see a fault in one place.
inline constexpr int kBlockEdge = 16;

/// Mean of a block of pixels per channel, and the variance of that mean with pixels taken as independent
/// (they share no samples).
struct Block {
  PixelRect rect;
  double mean[3] = {0, 0, 0};
  double variance[3] = {0, 0, 0};
};

/// The blocks of a region, row by row; those at the right and bottom edge may be smaller. The grid is
/// anchored at the region's corner; the region lies in the image's window. Without a variance layer the
/// variances are 0.
std::vector<Block> blocks(const FilmImage& image, const PixelRect& region, int edge = kBlockEdge);
std::vector<PixelRect> block_grid(const PixelRect& region, int edge = kBlockEdge);

/// Two estimates of the same numbers, compared one by one.
struct ZTest {
  int64_t compared = 0;  ///< pairs with a positive variance
  int64_t rejected = 0;  ///< |z| above the threshold, or unequal with zero variance
  double largest = 0;    ///< largest |z|; infinite where numbers of zero variance are unequal
  int64_t worst = -1;    ///< its index
  double threshold = 0;  ///< of |z|, two-sided, Šidák-corrected for all the pairs
  bool passes() const { return rejected == 0; }
};

/// Are a[i] and b[i] the same number for all i, given the variance of their difference? `relative` is the
/// rounding allowed between numbers of zero variance, and added (as a standard error) to every other:
/// pass the precision of the coarser side (float images: 1e-6).
ZTest z_test(std::span<const double> a, std::span<const double> b, std::span<const double> variance,
             double alpha, double relative = 1e-6);

/// y = exp(intercept) x^slope, fitted by least squares in log-log; `ci` is the confidence interval of the
/// slope from the residuals (Student's t, n - 2 degrees of freedom).
struct PowerLaw {
  double slope = 0, intercept = 0;
  ConfidenceInterval ci;
};
/// Nothing with fewer than three points, a coordinate that is not positive and finite, or equal x.
std::optional<PowerLaw> fit_power_law(std::span<const double> x, std::span<const double> y,
                                      double confidence = 0.95);

}  // namespace penumbra
