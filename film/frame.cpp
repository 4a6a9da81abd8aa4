#include "film/frame.h"

#include "film/moments.h"
#include "proto/status.h"

namespace penumbra {
namespace {

Moments moments_at(const Frame& frame, size_t pixel, size_t channel) {
  const size_t i = 3 * pixel + channel;
  return {frame.groups[pixel], static_cast<double>(frame.passes[pixel]), frame.mean[i], frame.m2[i]};
}

void merge_pixel(Frame& frame, size_t pixel, const TileView& tile, size_t source,
                 const std::pair<int64_t, int64_t>& counts) {
  const auto [passes, groups] = counts;
  for (size_t c = 0; c < 3; ++c) {
    Moments sum = moments_at(frame, pixel, c);
    sum.merge({groups, static_cast<double>(passes), tile.mean[3 * source + c], tile.m2[3 * source + c]});
    frame.mean[3 * pixel + c] = sum.mean;
    frame.m2[3 * pixel + c] = sum.m2;
  }
  frame.passes[pixel] += passes;
  frame.groups[pixel] += groups;
  if (!tile.cost.empty()) frame.cost[pixel] += tile.cost[source];  // bins have none
}

size_t checked_pixels(int width, int height, const PixelRect& crop) {
  PENUMBRA_CHECK(crop.width() > 0 && crop.height() > 0);
  PENUMBRA_CHECK(contains({0, 0, width, height}, crop));
  return static_cast<size_t>(crop.area());
}

}  // namespace

Frame::Frame(int full_width, int full_height, const PixelRect& rect)
    : width(full_width), height(full_height), crop(rect) {
  const size_t pixels = checked_pixels(full_width, full_height, rect);
  mean.resize(3 * pixels);
  m2.resize(3 * pixels);
  passes.resize(pixels);
  groups.resize(pixels);
  cost.resize(pixels);
}

void merge(Frame& frame, const TileView& tile) {
  if (tile.passes == 0) return;
  PENUMBRA_CHECK(contains(frame.crop, tile.rect));
  const size_t stride = static_cast<size_t>(frame.crop.width());
  size_t source = 0;
  for (int y = tile.rect.y0; y < tile.rect.y1; ++y) {
    size_t pixel =
        static_cast<size_t>(y - frame.crop.y0) * stride + static_cast<size_t>(tile.rect.x0 - frame.crop.x0);
    for (int x = tile.rect.x0; x < tile.rect.x1; ++x)
      merge_pixel(frame, pixel++, tile, source++, tile.counts_at(x, y));
  }
}

namespace {

FilmImage empty_image(const Frame& frame) {
  FilmImage image;
  image.width = frame.width;
  image.height = frame.height;
  image.window = frame.crop;
  return image;
}

}  // namespace

FilmImage resolve_rgb(const Frame& frame) {
  FilmImage image = empty_image(frame);
  image.rgb.assign(frame.mean.begin(), frame.mean.end());
  return image;
}

FilmImage resolve(const Frame& frame) {
  FilmImage image = resolve_rgb(frame);
  image.variance.resize(image.rgb.size());
  for (size_t i = 0; i < image.variance.size(); ++i)
    image.variance[i] = static_cast<float>(moments_at(frame, i / 3, i % 3).variance_of_mean());
  image.samples.assign(frame.passes.begin(), frame.passes.end());
  image.cost.assign(frame.cost.begin(), frame.cost.end());
  return image;
}

}  // namespace penumbra
