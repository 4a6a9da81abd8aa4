#include "film/estimate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include "proto/status.h"

namespace penumbra {
namespace {

// Of typical_log_ratio().
constexpr size_t kLeastParts = 8;
constexpr double kMostShare = 0.01, kMostPull = 0.5;

/// Lowers the largest until none is more than `most` of the sum (most > 1 / their number).
void cap_shares(std::vector<double>& weights, double most) {
  for (int round = 0; round < 64; ++round) {
    const double cap = most * std::accumulate(weights.begin(), weights.end(), 0.0);
    for (double& w : weights) w = std::min(w, cap);
  }
}

}  // namespace

double degrees_behind(std::span<const double> deviations) {
  // Scaled by the largest, so that fourth powers stay in range.
  double largest = 0;
  for (const double r : deviations) largest = std::max(largest, std::abs(r));
  if (!(largest > 0)) return std::numeric_limits<double>::infinity();
  double squares = 0, fourths = 0;
  for (const double r : deviations) {
    const double square = (r / largest) * (r / largest);
    squares += square;
    fourths += square * square;
  }
  const double n = static_cast<double>(deviations.size());
  const double excess = n * fourths / (squares * squares) - 1;  // κ - 1 >= 0
  // Equal magnitudes leave the rounding of the two sums.
  if (!(excess > n * std::numeric_limits<double>::epsilon())) return std::numeric_limits<double>::infinity();
  return 2 * n / excess;
}

ConfidenceInterval interval(const Estimate& e, double confidence) {
  PENUMBRA_CHECK(confidence > 0 && confidence < 1);
  if (e.standard_error == 0) return {e.value, e.value};
  const double p = 0.5 + confidence / 2;
  // Beyond this a quantile of t differs from the normal's by less than 1e-6.
  const double quantile =
      e.degrees_of_freedom > 1e6 ? normal_quantile(p) : t_quantile(p, e.degrees_of_freedom);
  return {e.value - quantile * e.standard_error, e.value + quantile * e.standard_error};
}

ConfidenceInterval exp_interval(const Estimate& e, double confidence) {
  const ConfidenceInterval i = interval(e, confidence);
  return {std::exp(i.low), std::exp(i.high)};
}

Estimate sum(const Estimate& a, const Estimate& b) {
  const double va = a.standard_error * a.standard_error, vb = b.standard_error * b.standard_error;
  Estimate out;
  out.value = a.value + b.value;
  out.standard_error = std::sqrt(va + vb);
  // Welch & Satterthwaite: (va + vb)² / (va²/νa + vb²/νb); in shares of the sum, to stay in range.
  const double share = va + vb > 0 ? va / (va + vb) : 0.5;
  const double spread =
      share * share / a.degrees_of_freedom + (1 - share) * (1 - share) / b.degrees_of_freedom;
  out.degrees_of_freedom = spread > 0 ? 1 / spread : std::numeric_limits<double>::infinity();
  return out;
}

std::optional<Estimate> paired_log_ratio(std::span<const double> a, std::span<const double> b) {
  return paired_log_product(std::array{Factor{a, 1}, Factor{b, -1}});
}

std::optional<Estimate> paired_log_product(std::span<const Factor> factors) {
  PENUMBRA_CHECK(!factors.empty());
  const size_t n = factors[0].parts.size();
  std::vector<double> deviations(n, 0.0);
  double value = 0;
  for (const auto& [parts, power] : factors) {
    PENUMBRA_CHECK(parts.size() == n);
    const double sum = std::accumulate(parts.begin(), parts.end(), 0.0);
    if (n < 2 || !(sum > 0) || !std::isfinite(sum)) return std::nullopt;
    value += power * std::log(sum);
    for (size_t i = 0; i < n; ++i) deviations[i] += power * (parts[i] / sum);
  }
  double squares = 0;
  for (const double d : deviations) squares += d * d;
  const double count = static_cast<double>(n);
  return Estimate{value, std::sqrt(squares * count / (count - 1)), degrees_behind(deviations)};
}

std::optional<Estimate> typical_log_ratio(std::span<const double> a, std::span<const double> b) {
  PENUMBRA_CHECK(a.size() == b.size());
  std::vector<double> weights, logs;
  for (size_t i = 0; i < a.size(); ++i) {
    if (!(a[i] > 0 && b[i] > 0)) continue;
    weights.push_back(std::sqrt(a[i] * b[i]));
    logs.push_back(std::log(a[i] / b[i]));
  }
  if (logs.size() < kLeastParts) return std::nullopt;
  cap_shares(weights, std::max(kMostShare, 2 / static_cast<double>(logs.size())));
  const auto pull = [&](size_t i, double value) {
    return weights[i] * std::clamp(logs[i] - value, -kMostPull, kMostPull);
  };
  // Their sum falls as the value rises: bisection, to rounding.
  auto [low, high] = std::minmax_element(logs.begin(), logs.end());
  double least = *low, most = *high;
  for (int round = 0; round < 64; ++round) {
    const double middle = (least + most) / 2;
    double sum = 0;
    for (size_t i = 0; i < logs.size(); ++i) sum += pull(i, middle);
    (sum > 0 ? least : most) = middle;
  }
  const double value = (least + most) / 2;
  double inside = 0, squares = 0;
  for (size_t i = 0; i < logs.size(); ++i) inside += std::abs(logs[i] - value) < kMostPull ? weights[i] : 0;
  if (!(inside > 0)) return std::nullopt;
  std::vector<double> deviations;
  for (size_t i = 0; i < logs.size(); ++i) {
    deviations.push_back(pull(i, value) / inside);
    squares += deviations.back() * deviations.back();
  }
  const double count = static_cast<double>(logs.size());
  return Estimate{value, std::sqrt(squares * count / (count - 1)), degrees_behind(deviations)};
}

std::optional<Estimate> mean_of(std::span<const double> values) {
  const double n = static_cast<double>(values.size());
  if (values.size() < 2) return std::nullopt;
  const double mean = std::accumulate(values.begin(), values.end(), 0.0) / n;
  double squares = 0;
  for (const double v : values) squares += (v - mean) * (v - mean);
  return Estimate{mean, std::sqrt(squares / (n - 1) / n), n - 1};
}

}  // namespace penumbra
