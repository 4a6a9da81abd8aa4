#pragma once
// A finished picture with what is known of its noise: what an EXR file holds, and what the server hands
// to the client.
#include <cstdint>
#include <vector>

#include "proto/job.h"

namespace penumbra {

/// Arrays are row-major over `window`; a layer that is absent is empty.
struct FilmImage {
  int width = 0, height = 0;    ///< full image, pixels
  PixelRect window;             ///< the part that is here, absolute pixels
  std::vector<float> rgb;       ///< 3 per pixel, mean radiance
  std::vector<float> variance;  ///< 3 per pixel, of the mean (standard error squared)
  std::vector<float> samples;   ///< 1 per pixel: passes
  std::vector<float> cost;      ///< 1 per pixel: CPU µs

  size_t pixels() const { return static_cast<size_t>(window.area()); }
  /// Place of an absolute pixel in the per-pixel arrays; x, y inside the window.
  size_t index(int x, int y) const {
    return static_cast<size_t>(y - window.y0) * static_cast<size_t>(window.width()) +
           static_cast<size_t>(x - window.x0);
  }
};

/// Largest images that are read; above it there is a lying header, not a picture.
inline constexpr int kMostImageEdge = 1 << 16;
inline constexpr int64_t kMostImagePixels = int64_t{1} << 27;

/// Common part of two rectangles; of zero width or height (never negative) where they do not meet.
PixelRect intersect(const PixelRect& a, const PixelRect& b);
bool contains(const PixelRect& outer, const PixelRect& inner);

}  // namespace penumbra
