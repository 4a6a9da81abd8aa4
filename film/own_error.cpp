#include "film/own_error.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "film/bootstrap.h"
#include "film/metrics.h"
#include "film/own_error_pixels.h"
#include "proto/status.h"

namespace penumbra {
namespace {

constexpr int kSmoothRadius = 2;

/// Mean over the 5×5 pixels around each, as far as they lie in the window: first along rows, then columns.
std::vector<double> smoothed(const FilmImage& image) {
  const int width = image.window.width(), height = image.window.height();
  const auto at = [&](int x, int y) {
    return 3 * (static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x));
  };
  std::vector<double> rows(image.rgb.size()), out(image.rgb.size());
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const int x0 = std::max(0, x - kSmoothRadius), x1 = std::min(width, x + kSmoothRadius + 1);
      for (size_t c = 0; c < 3; ++c) {
        double sum = 0;
        for (int i = x0; i < x1; ++i) sum += image.rgb[at(i, y) + c];
        rows[at(x, y) + c] = sum / (x1 - x0);
      }
    }
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const int y0 = std::max(0, y - kSmoothRadius), y1 = std::min(height, y + kSmoothRadius + 1);
      for (size_t c = 0; c < 3; ++c) {
        double sum = 0;
        for (int j = y0; j < y1; ++j) sum += rows[at(x, j) + c];
        out[at(x, y) + c] = sum / (y1 - y0);
      }
    }
  return out;
}

/// Per pixel, mean over channels of variance(i)/(R_i²+ε), i the place of a value in `image.rgb`.
template <class Variance>
std::vector<double> relative_pixels(const FilmImage& image, Variance variance) {
  const std::vector<double> mean = smoothed(image);
  std::vector<double> pixels;
  pixels.reserve(image.pixels());
  for (size_t p = 0; p < image.pixels(); ++p) {
    double sum = 0;
    for (size_t i = 3 * p; i < 3 * p + 3; ++i) sum += variance(i) / (mean[i] * mean[i] + kRelMseEpsilon);
    pixels.push_back(sum / 3);
  }
  return pixels;
}

/// Their mean. Nothing if that is not a number (a value that overflowed).
std::optional<OwnError> mean_of(const FilmImage& image, const std::vector<double>& pixels) {
  std::vector<BlockError> block_errors;
  BlockError total;
  for (const PixelRect& rect : block_grid(image.window)) {
    BlockError block{0, static_cast<double>(rect.area())};
    for (int y = rect.y0; y < rect.y1; ++y)
      for (int x = rect.x0; x < rect.x1; ++x) block.sum += pixels[image.index(x, y)];
    total.sum += block.sum;
    total.pixels += block.pixels;
    block_errors.push_back(block);
  }
  OwnError error{total.sum / total.pixels, bootstrap(block_errors)};
  if (!std::isfinite(error.relmse)) return std::nullopt;
  return error;
}

}  // namespace

std::vector<float> own_error_pixels(const FilmImage& image) {
  PENUMBRA_CHECK(image.variance.size() == image.rgb.size());
  const std::vector<double> pixels =
      relative_pixels(image, [&](size_t i) { return double{image.variance[i]}; });
  return {pixels.begin(), pixels.end()};
}

std::optional<OwnError> own_error(const FilmImage& image) {
  if (image.variance.empty() || image.samples.empty()) return std::nullopt;
  for (const float samples : image.samples)
    if (samples < 2) return std::nullopt;
  return mean_of(image, relative_pixels(image, [&](size_t i) { return double{image.variance[i]}; }));
}

std::optional<OwnError> own_error(const FilmImage& early, int64_t early_passes, const FilmImage& late,
                                  int64_t late_passes) {
  if (early_passes <= 0 || late_passes <= early_passes || early.window != late.window) return std::nullopt;
  const double whole = static_cast<double>(late_passes);
  const double factor = whole / static_cast<double>(late_passes - early_passes);
  const auto variance = [&](size_t i) {
    const double difference = double{early.rgb[i]} - double{late.rgb[i]};
    return difference * difference * factor;
  };
  return mean_of(late, relative_pixels(late, variance));
}

}  // namespace penumbra
