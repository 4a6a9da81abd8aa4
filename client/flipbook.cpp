#include "client/flipbook.h"

#include <algorithm>
#include <cmath>

#include "client/report_image.h"
#include "film/png.h"
#include "film/srgb.h"
#include "proto/status.h"

namespace penumbra {
namespace {

// Some ten megabytes of page.
constexpr double kMostPixels = 1 << 22;
/// Of the pixels that any light reaches, so many are shown without being cut off at white.
constexpr double kShown = 0.995;

struct Size {
  int scale = 1, width = 0, height = 0;
};

Size size_of(const std::vector<std::optional<ExrBins>>& mixes, const PixelRect& window) {
  double pixels = 0;
  for (const auto& mix : mixes)
    if (mix) pixels += static_cast<double>(window.area()) * static_cast<double>(mix->images.size());
  Size size;
  size.scale = std::max(1, static_cast<int>(std::ceil(std::sqrt(pixels / kMostPixels))));
  size.width = (window.width() + size.scale - 1) / size.scale;
  size.height = (window.height() + size.scale - 1) / size.scale;
  return size;
}

/// Means over scale × scale pixels, 3 per pixel; at the right and bottom edge over what there is.
std::vector<float> reduced(const FilmImage& image, const Size& size) {
  std::vector<float> out;
  out.reserve(3 * static_cast<size_t>(size.width) * static_cast<size_t>(size.height));
  const int w = image.window.width(), h = image.window.height();
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x)
      for (size_t c = 0; c < 3; ++c) {
        const int x1 = std::min((x + 1) * size.scale, w), y1 = std::min((y + 1) * size.scale, h);
        double sum = 0;
        for (int j = y * size.scale; j < y1; ++j)
          for (int i = x * size.scale; i < x1; ++i)
            sum +=
                image.rgb[3 * (static_cast<size_t>(j) * static_cast<size_t>(w) + static_cast<size_t>(i)) + c];
        out.push_back(static_cast<float>(sum / ((x1 - x * size.scale) * (y1 - y * size.scale))));
      }
  return out;
}

/// What is shown as white: kShown of the lit pixels of all frames are below.
double white_of(const std::vector<std::vector<std::vector<float>>>& books) {
  std::vector<float> lit;
  for (const auto& book : books)
    for (const auto& frame : book)
      for (size_t p = 0; p < frame.size(); p += 3) {
        const float largest = std::max({frame[p], frame[p + 1], frame[p + 2]});
        if (largest > 0) lit.push_back(largest);
      }
  if (lit.empty()) return 1;
  const auto at = lit.begin() + static_cast<std::ptrdiff_t>(kShown * static_cast<double>(lit.size() - 1));
  std::nth_element(lit.begin(), at, lit.end());
  return *at;
}

std::string png_of(const std::vector<float>& frame, const Size& size, double white) {
  std::vector<uint8_t> rgb(frame.size());
  std::transform(frame.begin(), frame.end(), rgb.begin(), [white](float v) {
    return static_cast<uint8_t>(std::lround(255 * srgb_encoded(v / white)));
  });
  return base64(png_bytes(size.width, size.height, rgb));
}

}  // namespace

Json flipbook_json(const std::vector<std::optional<ExrBins>>& mixes) {
  const auto first =
      std::find_if(mixes.begin(), mixes.end(), [](const auto& mix) { return mix.has_value(); });
  if (first == mixes.end()) return nullptr;
  const PixelRect window = (*first)->images[0].window;
  const Size size = size_of(mixes, window);
  std::vector<std::vector<std::vector<float>>> books(mixes.size());
  for (size_t m = 0; m < mixes.size(); ++m)
    if (mixes[m])
      for (const FilmImage& bin : mixes[m]->images)
        if (bin.window == window) books[m].push_back(reduced(bin, size));
  const double white = white_of(books);
  Json out = Json::array();
  for (const auto& book : books) {
    Json frames = Json::array();
    for (const std::vector<float>& frame : book) frames.push_back(png_of(frame, size, white));
    out.push_back(book.empty() ? Json(nullptr) : Json{{"frames", std::move(frames)}});
  }
  const Transient& t = (*first)->transient;
  return {{"t0", t.t0},
          {"t1", t.t1},
          {"bins", t.bins},
          {"scale", size.scale},
          {"width", size.width},
          {"height", size.height},
          {"mixes", std::move(out)}};
}

}  // namespace penumbra
