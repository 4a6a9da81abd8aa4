#include "worker/sampling/mis.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "proto/status.h"

namespace penumbra {
namespace {

/// p relative to the largest density, in [0,1]; against an infinite one, whether p is infinite too.
double relative_density(double p, double largest) {
  if (largest == 0) return 0;
  if (std::isinf(largest)) return std::isinf(p) ? 1 : 0;
  return p / largest;
}

double largest_of(std::span<const double> counts, std::span<const double> pdfs) {
  PENUMBRA_CHECK(counts.size() == pdfs.size());
  double largest = 0;
  for (size_t i = 0; i < pdfs.size(); ++i)
    if (counts[i] > 0) largest = std::max(largest, pdfs[i]);
  return largest;
}

/// Divides by the sum; leaves all zero if it is zero.
void normalise(std::span<double> weights) {
  double sum = 0;
  for (const double w : weights) sum += w;
  if (sum == 0) return;
  for (double& w : weights) w /= sum;
}

}  // namespace

void balance_weights(std::span<const double> counts, std::span<const double> pdfs,
                     std::span<const double> smoothing, std::span<double> out) {
  PENUMBRA_CHECK(out.size() == pdfs.size() && (smoothing.empty() || smoothing.size() == pdfs.size()));
  const auto factor = [&](size_t i) { return smoothing.empty() ? 1.0 : smoothing[i]; };
  // Only densities that a factor leaves in the sum set the scale: beside an enormous one that is smoothed
  // away, the others would vanish. If the factors leave nothing, the plain heuristic decides.
  double largest = 0;
  for (size_t i = 0; i < pdfs.size(); ++i)
    if (counts[i] > 0 && factor(i) > 0) largest = std::max(largest, pdfs[i]);
  const double plain_largest = largest_of(counts, pdfs);
  const bool smooth = largest > 0 && !(std::isinf(plain_largest) && !std::isinf(largest));
  if (!smooth) largest = plain_largest;
  for (size_t i = 0; i < pdfs.size(); ++i) {
    // A density without a say is not even divided: it may be as large as it likes.
    const double share = counts[i] * (smooth ? factor(i) : 1.0);
    out[i] = share > 0 ? share * relative_density(pdfs[i], largest) : 0;
  }
  normalise(out);
}

void power_weights(std::span<const double> counts, std::span<const double> pdfs, std::span<double> out) {
  PENUMBRA_CHECK(out.size() == pdfs.size());
  const double largest = largest_of(counts, pdfs);
  for (size_t i = 0; i < pdfs.size(); ++i) {
    const double q = counts[i] > 0 ? counts[i] * relative_density(pdfs[i], largest) : 0;
    out[i] = q * q;
  }
  normalise(out);
}

double inverse_sum(std::span<const double> counts, std::span<const double> pdfs) {
  const double largest = largest_of(counts, pdfs);
  if (largest == 0) return std::numeric_limits<double>::infinity();
  if (std::isinf(largest)) return 0;
  double sum = 0;
  for (size_t i = 0; i < pdfs.size(); ++i)
    if (counts[i] > 0) sum += counts[i] * (pdfs[i] / largest);
  return 1 / sum / largest;
}

}  // namespace penumbra
