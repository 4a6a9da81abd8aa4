#include "film/metrics.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "film/estimate.h"
#include "proto/status.h"

namespace penumbra {
namespace {

constexpr double kTrimmedShare = 1e-3;
constexpr double kConfidence = 0.95;
// Edge of the cells within which pixels count as equally hard.
constexpr int kCellEdge = 2;
constexpr int kLeastBlockEdge = 4;
constexpr int64_t kMostBlocks = 1024;

/// Errors of the pixels of a region, row by row.
struct PixelErrors {
  PixelRect region;
  std::vector<double> relative;
  std::vector<double> variance;  ///< empty without the image's variance layer

  size_t index(int x, int y) const {
    return static_cast<size_t>(y - region.y0) * static_cast<size_t>(region.width()) +
           static_cast<size_t>(x - region.x0);
  }
  double at(int x, int y) const { return relative[index(x, y)]; }
};

/// Sum and standard error of the pixels of each cell: appends deviations whose squares sum up to the
/// variance of Σ e_p. Of n pixels Σ (e - mean)² n/(n - 1) is n s².
void append_deviations(const PixelErrors& errors, const PixelRect& cell, std::vector<double>& deviations) {
  const auto n = static_cast<double>(cell.area());
  double sum = 0;
  for (int y = cell.y0; y < cell.y1; ++y)
    for (int x = cell.x0; x < cell.x1; ++x) sum += errors.at(x, y);
  // A cell cut to one pixel by the region's edge has no neighbour: its square bounds its variance.
  const double mean = n > 1 ? sum / n : 0, scale = n > 1 ? std::sqrt(n / (n - 1)) : 1;
  for (int y = cell.y0; y < cell.y1; ++y)
    for (int x = cell.x0; x < cell.x1; ++x) deviations.push_back((errors.at(x, y) - mean) * scale);
}

std::optional<ConfidenceInterval> interval_of(const PixelErrors& errors, double total) {
  if (errors.relative.size() < 2 || !(total > 0)) return std::nullopt;
  std::vector<double> deviations;
  deviations.reserve(errors.relative.size());
  for (const PixelRect& cell : block_grid(errors.region, kCellEdge))
    append_deviations(errors, cell, deviations);
  double squares = 0;
  for (const double d : deviations) squares += d * d;
  const double pixels = static_cast<double>(errors.relative.size());
  return exp_interval({std::log(total / pixels), std::sqrt(squares) / total, degrees_behind(deviations)},
                      kConfidence);
}

double mean_over(const PixelErrors& errors, const std::vector<double>& values, const PixelRect& rect) {
  double sum = 0;
  for (int y = rect.y0; y < rect.y1; ++y)
    for (int x = rect.x0; x < rect.x1; ++x) sum += values[errors.index(x, y)];
  return sum / static_cast<double>(rect.area());
}

ErrorBlocks blocks_of(const PixelErrors& errors) {
  ErrorBlocks blocks;
  blocks.edge = kLeastBlockEdge;
  const auto count = [&](int64_t edge) {
    return ((errors.region.width() + edge - 1) / edge) * ((errors.region.height() + edge - 1) / edge);
  };
  while (count(blocks.edge) > kMostBlocks) blocks.edge *= 2;
  for (const PixelRect& rect : block_grid(errors.region, blocks.edge)) {
    blocks.relmse.push_back(mean_over(errors, errors.relative, rect));
    if (!errors.variance.empty()) blocks.variance.push_back(mean_over(errors, errors.variance, rect));
  }
  return blocks;
}

/// Mean of the values but for the largest `share` of them (at least one is kept).
double trimmed_mean(std::vector<double> values, double share) {
  const auto dropped = static_cast<size_t>(share * static_cast<double>(values.size()));
  const auto kept = static_cast<std::ptrdiff_t>(values.size() - dropped);
  if (dropped > 0) std::nth_element(values.begin(), values.begin() + kept - 1, values.end());
  return std::accumulate(values.begin(), values.begin() + kept, 0.0) / static_cast<double>(kept);
}

absl::Status check_finite(const FilmImage& image, const PixelRect& region, const char* which) {
  int64_t bad = 0;
  int bad_x = 0, bad_y = 0;
  for (int y = region.y0; y < region.y1; ++y)
    for (int x = region.x0; x < region.x1; ++x) {
      const float* v = &image.rgb[3 * image.index(x, y)];
      if (std::isfinite(v[0]) && std::isfinite(v[1]) && std::isfinite(v[2])) continue;
      if (bad++ == 0) bad_x = x, bad_y = y;
    }
  if (bad == 0) return absl::OkStatus();
  return invalid_input("{} has {} pixels that are not finite, the first at {},{}", which, bad, bad_x, bad_y);
}

absl::Status check_region(const FilmImage& image, const FilmImage& reference, const PixelRect& region) {
  if (image.width != reference.width || image.height != reference.height)
    return invalid_input("the image is {}x{}, the reference {}x{}", image.width, image.height,
                         reference.width, reference.height);
  const auto text = [](const PixelRect& r) { return fmt::format("{},{},{},{}", r.x0, r.y0, r.x1, r.y1); };
  if (region.x0 >= region.x1 || region.y0 >= region.y1)
    return invalid_input("region {} is empty", text(region));
  if (!contains(image.window, region))
    return invalid_input("region {} is not in the image, which covers {}", text(region), text(image.window));
  if (!contains(reference.window, region))
    return invalid_input("region {} is not in the reference, which covers {}", text(region),
                         text(reference.window));
  RETURN_IF_ERROR(check_finite(image, region, "the image"));
  return check_finite(reference, region, "the reference");
}

/// What one pixel adds, channels averaged.
struct PixelError {
  double relative = 0, squared = 0, floor = 0, variance = 0;
};

PixelError pixel_error(const FilmImage& image, const FilmImage& reference, int x, int y, double epsilon) {
  PixelError e;
  const size_t i = 3 * image.index(x, y), j = 3 * reference.index(x, y);
  for (size_t c = 0; c < 3; ++c) {
    const double r = reference.rgb[j + c], d = image.rgb[i + c] - r, scale = r * r + epsilon;
    e.relative += d * d / scale / 3;
    e.squared += d * d / 3;
    if (!reference.variance.empty()) e.floor += reference.variance[j + c] / scale / 3;
    if (!image.variance.empty()) e.variance += image.variance[i + c] / scale / 3;
  }
  return e;
}

}  // namespace

absl::StatusOr<ErrorFigures> compare(const FilmImage& image, const FilmImage& reference,
                                     std::optional<PixelRect> region, double epsilon) {
  PENUMBRA_CHECK(epsilon > 0);
  ErrorFigures figures;
  figures.region = region.value_or(image.window);
  RETURN_IF_ERROR(check_region(image, reference, figures.region));
  PixelErrors errors{figures.region, {}, {}};
  errors.relative.reserve(static_cast<size_t>(figures.region.area()));
  PixelError total;
  for (int y = figures.region.y0; y < figures.region.y1; ++y)
    for (int x = figures.region.x0; x < figures.region.x1; ++x) {
      const PixelError e = pixel_error(image, reference, x, y, epsilon);
      errors.relative.push_back(e.relative);
      if (!image.variance.empty()) errors.variance.push_back(e.variance);
      total.relative += e.relative;
      total.squared += e.squared;
      total.floor += e.floor;
      total.variance += e.variance;
    }
  const auto pixels = static_cast<double>(figures.region.area());
  figures.relmse = total.relative / pixels;
  figures.mse = total.squared / pixels;
  if (!reference.variance.empty()) figures.reference_floor = total.floor / pixels;
  if (!image.variance.empty()) figures.variance = total.variance / pixels;
  figures.relmse_ci = interval_of(errors, total.relative);
  figures.blocks = blocks_of(errors);
  figures.trimmed_relmse = trimmed_mean(std::move(errors.relative), kTrimmedShare);
  return figures;
}

}  // namespace penumbra
