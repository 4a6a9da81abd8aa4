#include "film/statistics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "proto/status.h"

namespace penumbra {
namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

/// Continued fraction of the incomplete beta function (DLMF 8.17.22), by the modified Lentz algorithm.
/// Converges in O(sqrt(max(a, b))) terms for x < (a + 1)/(a + b + 2).
double beta_fraction(double a, double b, double x) {
  // Lentz replaces a vanishing denominator by a number too small to matter.
  constexpr double kTiny = std::numeric_limits<double>::min() / kEpsilon;
  const auto guard = [](double v) { return std::abs(v) < kTiny ? kTiny : v; };
  double c = 1, d = 1 / guard(1 - (a + b) * x / (a + 1)), f = d;
  for (double m = 1;; ++m) {
    const double even = m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m));
    d = 1 / guard(1 + even * d);
    c = guard(1 + even / c);
    f *= d * c;
    const double odd = -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1));
    d = 1 / guard(1 + odd * d);
    c = guard(1 + odd / c);
    f *= d * c;
    if (std::abs(d * c - 1) <= 2 * kEpsilon) return f;
  }
}

/// Regularised incomplete beta function I_x(a, b) with y = 1 - x given apart, so that neither cancels.
double incomplete_beta(double a, double b, double x, double y) {
  if (x <= 0) return 0;
  if (y <= 0) return 1;
  const double log_front =
      std::lgamma(a + b) - std::lgamma(a) - std::lgamma(b) + a * std::log(x) + b * std::log(y);
  const double front = std::exp(log_front);
  if (x < (a + 1) / (a + b + 2)) return front * beta_fraction(a, b, x) / a;
  return 1 - front * beta_fraction(b, a, y) / b;
}

}  // namespace

double normal_tail(double z) {
  return 0.5 * std::erfc(z / std::numbers::sqrt2);
}

double normal_quantile(double p) {
  PENUMBRA_CHECK(p > 0 && p < 1);
  if (p == 0.5) return 0;
  if (p > 0.5) return -normal_quantile(1 - p);
  // Newton on log Q(z) = log p for the upper tail Q, Q'/Q = -phi/Q. log Q is concave and decreasing, so
  // that iterates from the right of the root fall to it without crossing; Q(z) <= exp(-z²/2)/2 gives the
  // start.
  double z = std::sqrt(-2 * std::log(2 * p));
  for (int i = 0; i < 100; ++i) {
    const double tail = normal_tail(z);
    const double density = std::exp(-0.5 * z * z) / std::sqrt(2 * std::numbers::pi);
    const double step = std::log(tail / p) * tail / density;
    z += step;
    if (std::abs(step) <= 4 * kEpsilon * std::abs(z)) break;
  }
  return -z;
}

double t_tail(double t, double n) {
  PENUMBRA_CHECK(n > 0);
  if (t < 0) return 1 - t_tail(-t, n);
  // P(|T| > t) = I_x(n/2, 1/2) with x = n / (n + t²).
  const double square = t * t;
  return 0.5 * incomplete_beta(n / 2, 0.5, n / (n + square), square / (n + square));
}

double t_quantile(double p, double n) {
  PENUMBRA_CHECK(p > 0 && p < 1);
  if (p == 0.5) return 0;
  if (p < 0.5) return -t_quantile(1 - p, n);
  const double tail = 1 - p;
  double low = 0, high = 1;
  while (t_tail(high, n) > tail) {
    low = high;
    high *= 2;
  }
  while (high - low > 2 * kEpsilon * high) {
    const double middle = 0.5 * (low + high);
    if (middle <= low || middle >= high) break;
    (t_tail(middle, n) > tail ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

double sidak(double alpha, int64_t n) {
  PENUMBRA_CHECK(alpha > 0 && alpha < 1 && n >= 1);
  return -std::expm1(std::log1p(-alpha) / static_cast<double>(n));
}

std::vector<PixelRect> block_grid(const PixelRect& region, int edge) {
  PENUMBRA_CHECK(edge > 0);
  std::vector<PixelRect> grid;
  for (int y = region.y0; y < region.y1; y += edge)
    for (int x = region.x0; x < region.x1; x += edge)
      grid.push_back({x, y, std::min(x + edge, region.x1), std::min(y + edge, region.y1)});
  return grid;
}

std::vector<Block> blocks(const FilmImage& image, const PixelRect& region, int edge) {
  PENUMBRA_CHECK(contains(image.window, region));
  std::vector<Block> out;
  for (const PixelRect& rect : block_grid(region, edge)) {
    Block block{rect};
    for (int y = rect.y0; y < rect.y1; ++y)
      for (int x = rect.x0; x < rect.x1; ++x)
        for (size_t c = 0; c < 3; ++c) {
          const size_t i = 3 * image.index(x, y) + c;
          block.mean[c] += image.rgb[i];
          if (!image.variance.empty()) block.variance[c] += image.variance[i];
        }
    const auto pixels = static_cast<double>(rect.area());
    for (size_t c = 0; c < 3; ++c) {
      block.mean[c] /= pixels;
      block.variance[c] /= pixels * pixels;
    }
    out.push_back(block);
  }
  return out;
}

ZTest z_test(std::span<const double> a, std::span<const double> b, std::span<const double> variance,
             double alpha, double relative) {
  PENUMBRA_CHECK(a.size() == b.size() && a.size() == variance.size() && !a.empty());
  ZTest test;
  test.threshold = -normal_quantile(sidak(alpha, static_cast<int64_t>(a.size())) / 2);
  for (size_t i = 0; i < a.size(); ++i) {
    const double difference = std::abs(a[i] - b[i]);
    const double rounding = relative * std::max(std::abs(a[i]), std::abs(b[i]));
    double z = 0;
    if (variance[i] > 0) {
      ++test.compared;
      z = difference / std::sqrt(variance[i] + rounding * rounding);
    } else if (difference > rounding) {
      z = std::numeric_limits<double>::infinity();
    }
    // Written so that a NaN is rejected.
    if (!(z <= test.threshold)) ++test.rejected;
    if (!(z <= test.largest)) {
      test.largest = z;
      test.worst = static_cast<int64_t>(i);
    }
  }
  return test;
}

std::optional<PowerLaw> fit_power_law(std::span<const double> x, std::span<const double> y,
                                      double confidence) {
  PENUMBRA_CHECK(x.size() == y.size() && confidence > 0 && confidence < 1);
  const size_t n = x.size();
  if (n < 3) return std::nullopt;
  double mean_x = 0, mean_y = 0;
  for (size_t i = 0; i < n; ++i) {
    if (!(x[i] > 0 && y[i] > 0 && std::isfinite(x[i]) && std::isfinite(y[i]))) return std::nullopt;
    mean_x += std::log(x[i]) / static_cast<double>(n);
    mean_y += std::log(y[i]) / static_cast<double>(n);
  }
  double xx = 0, xy = 0;
  for (size_t i = 0; i < n; ++i) {
    const double dx = std::log(x[i]) - mean_x;
    xx += dx * dx;
    xy += dx * (std::log(y[i]) - mean_y);
  }
  // Equal x leave only the rounding of their logarithms.
  if (xx <= static_cast<double>(n) * std::pow(kEpsilon * std::max(1.0, std::abs(mean_x)), 2))
    return std::nullopt;
  PowerLaw law;
  law.slope = xy / xx;
  law.intercept = mean_y - law.slope * mean_x;
  double residual = 0;
  for (size_t i = 0; i < n; ++i) {
    const double r = std::log(y[i]) - law.intercept - law.slope * std::log(x[i]);
    residual += r * r;
  }
  const auto freedom = static_cast<double>(n - 2);
  const double half = t_quantile(0.5 + confidence / 2, freedom) * std::sqrt(residual / freedom / xx);
  law.ci = {law.slope - half, law.slope + half};
  return law;
}

}  // namespace penumbra
