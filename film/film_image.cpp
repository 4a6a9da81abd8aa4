#include "film/film_image.h"

#include <algorithm>
#include <array>

#include "film/bytes.h"
#include "proto/status.h"

namespace penumbra {
namespace {

constexpr std::string_view kMagic = "PNIM";
constexpr uint32_t kVersion = 1;

/// A layer of an image and its floats per pixel.
struct Layer {
  std::vector<float> FilmImage::*values;
  size_t channels;
};
constexpr std::array<Layer, 4> kLayers = {
    {{&FilmImage::rgb, 3}, {&FilmImage::variance, 3}, {&FilmImage::samples, 1}, {&FilmImage::cost, 1}}};

std::string fault_of_shape(const FilmImage& image) {
  const PixelRect& w = image.window;
  if (image.width < 1 || image.height < 1 || image.width > kMostImageEdge || image.height > kMostImageEdge ||
      int64_t{image.width} * image.height > kMostImagePixels)
    return fmt::format("resolution {}x{} is out of range", image.width, image.height);
  if (w.x0 >= w.x1 || w.y0 >= w.y1 || !contains({0, 0, image.width, image.height}, w))
    return fmt::format("window {},{},{},{} does not lie in {}x{}", w.x0, w.y0, w.x1, w.y1, image.width,
                       image.height);
  return {};
}

}  // namespace

PixelRect intersect(const PixelRect& a, const PixelRect& b) {
  PixelRect r{std::max(a.x0, b.x0), std::max(a.y0, b.y0), std::min(a.x1, b.x1), std::min(a.y1, b.y1)};
  r.x1 = std::max(r.x0, r.x1);
  r.y1 = std::max(r.y0, r.y1);
  return r;
}

bool contains(const PixelRect& outer, const PixelRect& inner) {
  return outer.x0 <= inner.x0 && outer.y0 <= inner.y0 && inner.x1 <= outer.x1 && inner.y1 <= outer.y1;
}

std::string serialize(const FilmImage& image) {
  PENUMBRA_CHECK(fault_of_shape(image).empty());
  ByteWriter out;
  out.put(kMagic);
  out.put(kVersion);
  const PixelRect& w = image.window;
  for (const int32_t number : {image.width, image.height, w.x0, w.y0, w.x1, w.y1}) out.put(number);
  uint32_t present = 0;
  for (size_t l = 0; l < kLayers.size(); ++l) {
    const std::vector<float>& values = image.*kLayers[l].values;
    PENUMBRA_CHECK(values.empty() || values.size() == kLayers[l].channels * image.pixels());
    if (!values.empty()) present |= 1u << l;
  }
  out.put(present);
  for (const Layer& layer : kLayers) out.put(image.*layer.values);
  return out.take();
}

absl::StatusOr<FilmImage> parse_film_image(std::string_view bytes) {
  ByteReader in(bytes);
  uint32_t version = 0, present = 0;
  if (!in.expect(kMagic) || !in.get(version)) return invalid_input("image: not an image");
  if (version != kVersion) return invalid_input("image: version {}, not {}", version, kVersion);
  FilmImage image;
  PixelRect& w = image.window;
  for (int* number : {&image.width, &image.height, &w.x0, &w.y0, &w.x1, &w.y1})
    if (!in.get(*number)) return invalid_input("image: truncated");
  if (!in.get(present)) return invalid_input("image: truncated");
  if (present >= 1u << kLayers.size()) return invalid_input("image: unknown layers {:#x}", present);
  if (const std::string fault = fault_of_shape(image); !fault.empty())
    return invalid_input("image: {}", fault);
  for (size_t l = 0; l < kLayers.size(); ++l)
    if ((present >> l & 1u) && !in.get(image.*kLayers[l].values, kLayers[l].channels * image.pixels()))
      return invalid_input("image: truncated");
  if (in.left() != 0) return invalid_input("image: {} bytes too many", in.left());
  return image;
}

}  // namespace penumbra
