#include "server/auto_compare.h"

#include <algorithm>
#include <numeric>

namespace penumbra {
namespace {

// What a tile's own measurement is weighed against, in pixels: those of each neighbour and of the whole
// image, for how much varies here (level) and for how candidates compare (ratio). Levels change from tile to
// tile.
constexpr double kNeighbourLevelPixels = 1, kImageLevelPixels = 1;
constexpr double kNeighbourRatioPixels = 4, kImageRatioPixels = 16;
constexpr double kMostRatio = 256;

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Weighted mean of a tile's own figure (weight: the pixels it is worth), its neighbours' and the image's.
/// Figures are in units of what is typical of the image.
struct Blend {
  double neighbour_pixels, image_pixels, image_figure;
};
double blended(const std::vector<double>& figures, const std::vector<double>& pixels, const Blend& blend,
               size_t t, size_t columns) {
  double sum = pixels[t] * figures[t] + blend.image_pixels * blend.image_figure;
  double weight = pixels[t] + blend.image_pixels;
  for (const size_t other : neighbours(t, columns, figures.size())) {
    const double w = std::min(blend.neighbour_pixels, pixels[other]);
    sum += w * figures[other];
    weight += w;
  }
  return sum / weight;
}

/// How a tile compares with the image: the median over the candidates of figure_tk / typical_k, their mean
/// where most of them found nothing.
double level_of(const std::vector<double>& figures, const std::vector<double>& typical) {
  std::vector<double> relative;
  for (size_t k = 0; k < figures.size(); ++k)
    if (typical[k] > 0) relative.push_back(figures[k] / typical[k]);
  if (relative.empty()) return 0;
  const double mean =
      std::accumulate(relative.begin(), relative.end(), 0.0) / static_cast<double>(relative.size());
  const double middle = median(std::move(relative));
  return middle > 0 ? middle : mean;
}

std::vector<double> column(const Table& table, size_t k) {
  std::vector<double> out;
  for (const std::vector<double>& row : table) out.push_back(row[k]);
  return out;
}

}  // namespace

std::vector<size_t> neighbours(size_t t, size_t columns, size_t tiles) {
  std::vector<size_t> out;
  const auto x = static_cast<ptrdiff_t>(t % columns), y = static_cast<ptrdiff_t>(t / columns);
  for (ptrdiff_t j = y - 1; j <= y + 1; ++j)
    for (ptrdiff_t i = x - 1; i <= x + 1; ++i) {
      const ptrdiff_t other = j * static_cast<ptrdiff_t>(columns) + i;
      const bool inside = i >= 0 && i < static_cast<ptrdiff_t>(columns) && j >= 0;
      if (inside && other < static_cast<ptrdiff_t>(tiles) && other != static_cast<ptrdiff_t>(t))
        out.push_back(static_cast<size_t>(other));
    }
  return out;
}

std::vector<double> typical(const Table& figures, const std::vector<double>& areas) {
  std::vector<double> sums(figures[0].size(), 0);
  const double area = std::accumulate(areas.begin(), areas.end(), 0.0);
  for (size_t t = 0; t < figures.size(); ++t)
    for (size_t k = 0; k < sums.size(); ++k) sums[k] += areas[t] * figures[t][k] / area;
  return sums;
}

constexpr Blend kLevelBlend{kNeighbourLevelPixels, kImageLevelPixels, 1};

Table comparable(const Table& figures, const Table& pixels, const std::vector<double>& image,
                 const std::vector<double>& image_ratios, size_t columns) {
  Table out = figures;
  std::vector<double> levels, worth;
  for (size_t t = 0; t < figures.size(); ++t) {
    levels.push_back(level_of(figures[t], image));
    worth.push_back(median(pixels[t]));
  }
  for (size_t k = 0; k < image.size(); ++k) {
    // Where next to nothing varies a ratio may be anything: beyond these bounds it says «far better» or «far
    // worse», and not by how much.
    std::vector<double> ratios;
    for (size_t t = 0; t < figures.size(); ++t)
      ratios.push_back(levels[t] > 0 && image[k] > 0
                           ? std::clamp(figures[t][k] / (levels[t] * image[k]), 1 / kMostRatio, kMostRatio)
                           : 1);
    const std::vector<double> weights = column(pixels, k);
    const Blend ratio_blend{kNeighbourRatioPixels, kImageRatioPixels, image_ratios[k]};
    for (size_t t = 0; t < figures.size(); ++t)
      out[t][k] = blended(levels, worth, kLevelBlend, t, columns) * image[k] *
                  blended(ratios, weights, ratio_blend, t, columns);
  }
  return out;
}

Table smoothed(const Table& figures, const Table& pixels, const std::vector<double>& image, size_t columns) {
  Table out = figures;
  for (size_t k = 0; k < image.size(); ++k) {
    if (!(image[k] > 0)) continue;
    std::vector<double> relative = column(figures, k);
    for (double& figure : relative) figure /= image[k];
    const std::vector<double> weights = column(pixels, k);
    for (size_t t = 0; t < figures.size(); ++t)
      out[t][k] = image[k] * blended(relative, weights, kLevelBlend, t, columns);
  }
  return out;
}

}  // namespace penumbra
