#pragma once
// The image of one mix while it grows: what the assembler merges tile results into.
#include <cstdint>
#include <vector>

#include "film/film_image.h"
#include "film/tile_pixels.h"
#include "proto/job.h"

namespace penumbra {

/// Moments of every pixel of a crop. Sums are kept in double; the counts are per pixel, because tiles
/// arrive at different times (and `auto` gives tiles different plans).
struct Frame {
  Frame() = default;
  Frame(int width, int height, const PixelRect& crop);

  int width = 0, height = 0;    ///< full image, pixels
  PixelRect crop;               ///< the part that is rendered; arrays are row-major over it
  std::vector<double> mean;     ///< 3 per pixel
  std::vector<double> m2;       ///< 3 per pixel
  std::vector<int64_t> passes;  ///< 1 per pixel
  std::vector<int64_t> groups;  ///< 1 per pixel
  std::vector<double> cost;     ///< 1 per pixel: CPU µs
};

/// Adds a tile, which must lie in the crop. The image is a function of the sequence of merges: for
/// bit-identity call it in the order of task ids, whatever the order of arrival.
void merge(Frame& frame, const TileView& tile);

/// Mean, variance of the mean, samples and cost in single precision. Pixels without a pass are black
/// with 0 samples.
FilmImage resolve(const Frame& frame);
/// Only the mean: all that a checkpoint shows.
FilmImage resolve_rgb(const Frame& frame);

}  // namespace penumbra
