#pragma once
// A number from noisy parts, and how sure it is: sums over pixels, ratios of two runs' sums.
#include <optional>
#include <span>

#include "film/statistics.h"

namespace penumbra {

/// An estimate on the scale on which its error is near normal (for positive figures their logarithm).
struct Estimate {
  double value = 0;
  double standard_error = 0;      ///< of value
  double degrees_of_freedom = 1;  ///< behind the standard error; infinite where that is known
};

/// Degrees of freedom of a variance that was estimated as a sum of squares of n independent deviations.
/// s² has relative variance (κ - 1)/n with the kurtosis κ = n Σr⁴/(Σr²)²; a χ² of ν degrees has 2/ν; hence
/// ν = 2n/(κ - 1). Normal deviations give about n; a single one that outweighs all others gives 2, so that
/// a firefly widens an interval by more than its size. Infinite where all deviations are equally large.
double degrees_behind(std::span<const double> deviations);

/// value ± t · standard error; `confidence` two-sided in (0,1).
ConfidenceInterval interval(const Estimate& estimate, double confidence);
/// The same in the other scale: exp of both ends.
ConfidenceInterval exp_interval(const Estimate& estimate, double confidence);

/// a + b of independent estimates: variances add, degrees of freedom by Welch & Satterthwaite.
Estimate sum(const Estimate& a, const Estimate& b);

/// log(Σa / Σb) where a[i] and b[i] are two runs' figures of the same part i (of a block of pixels, of a
/// tile) and parts are independent. What makes a part hard is common to both and cancels: with the sums A, B
/// the derivative gives deviations r_i = a_i/A - b_i/B and the variance n/(n - 1) Σ r_i² (delta method).
/// Equal lists give 0 ± 0. Nothing with fewer than two parts or a sum that is not positive and finite.
std::optional<Estimate> paired_log_ratio(std::span<const double> a, std::span<const double> b);

/// log of Π_k (Σ_i parts_k[i])^(power_k), all lists of the same parts: deviations Σ_k power_k parts_k[i] /
/// (sum of k).
struct Factor {
  std::span<const double> parts;
  double power = 1;
};
std::optional<Estimate> paired_log_product(std::span<const Factor> factors);

/// The log ratio that is typical of the parts: Huber's M-estimate of log(a[i] / b[i]), each part weighed by
/// its share, √(a[i] b[i]) over the sum of these but 1/100 at most, and pulling no harder than a part that is
/// off by exp(1/2). Two lists that are exchangeable give 0 in the mean, and a common factor is found, however
/// heavy the tails: of figures of variance one part in a thousand may hold a tenth. What has changed in few
/// parts only it does not tell. Standard error from its influence function (Huber 1981, §3.2). Nothing with
/// fewer than eight parts that are positive in both.
std::optional<Estimate> typical_log_ratio(std::span<const double> a, std::span<const double> b);

/// Mean of the values with its standard error, n - 1 degrees of freedom. Nothing with fewer than two.
std::optional<Estimate> mean_of(std::span<const double> values);

}  // namespace penumbra
