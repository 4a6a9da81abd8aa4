#include "client/report_image.h"

#include <half.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "film/metrics.h"
#include "film/own_error_pixels.h"
#include "proto/status.h"

namespace penumbra {
namespace {

// A page with five images of this size stays near 40 MB.
constexpr int64_t kMostPixels = int64_t{1} << 20;
constexpr int kHalfBits = 10;  // stored bits of a half's significand
constexpr int kHeatBits = 7;   // of a false colour's: its table has 256 entries
constexpr double kErrorUnit = 1.0 / 4096;

/// How an image is made smaller: means over scale × scale pixels; those at the right and bottom edge over
/// what there is.
struct Reduction {
  PixelRect window;
  int scale = 1, width = 0, height = 0;

  explicit Reduction(const PixelRect& whole) : window(whole) {
    const double excess = static_cast<double>(window.area()) / static_cast<double>(kMostPixels);
    scale = std::max(1, static_cast<int>(std::ceil(std::sqrt(excess))));
    width = (window.width() + scale - 1) / scale;
    height = (window.height() + scale - 1) / scale;
  }
  /// value(p) is what pixel number p of the window has.
  template <class Value>
  std::vector<float> plane(Value value) const {
    std::vector<float> out;
    out.reserve(static_cast<size_t>(width) * static_cast<size_t>(height));
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        const int x1 = std::min((x + 1) * scale, window.width()),
                  y1 = std::min((y + 1) * scale, window.height());
        double sum = 0;
        for (int j = y * scale; j < y1; ++j)
          for (int i = x * scale; i < x1; ++i)
            sum +=
                value(static_cast<size_t>(j) * static_cast<size_t>(window.width()) + static_cast<size_t>(i));
        out.push_back(static_cast<float>(sum / ((x1 - x * scale) * (y1 - y * scale))));
      }
    return out;
  }
};

/// The power of two, at least `least`, in whose multiples every finite value is a half.
double unit_of(const std::vector<std::vector<float>>& planes, double least) {
  double most = 0;
  for (const std::vector<float>& plane : planes)
    for (const float v : plane)
      if (std::isfinite(v)) most = std::max(most, std::abs(double{v}));
  double unit = least;
  while (most / unit > HALF_MAX) unit *= 2;
  return unit;
}

/// `v` with `bits` stored bits of its significand, rounded to nearest: the zeros behind them pack well.
uint16_t half_bits(double v, int bits) {
  const uint32_t step = 1u << (kHalfBits - bits);
  const uint32_t exact = Imath::half(static_cast<float>(v)).bits();
  const uint32_t rounded = (exact + step / 2) & ~(step - 1);
  // Rounding up may reach infinity (0x7c00): then down.
  return static_cast<uint16_t>((rounded & 0x7fff) >= 0x7c00 ? exact & ~(step - 1) : rounded);
}

/// What relMSE averages, of pixel number p of both windows.
double relative_error(const FilmImage& image, const FilmImage& reference, size_t p) {
  double sum = 0;
  for (size_t i = 3 * p; i < 3 * p + 3; ++i) {
    const double r = reference.rgb[i], d = image.rgb[i] - r;
    sum += d * d / (r * r + kRelMseEpsilon);
  }
  return sum / 3;
}

std::string deflate(const std::string& bytes) {
  uLongf size = compressBound(bytes.size());
  std::string out(size, '\0');
  PENUMBRA_CHECK(compress2(reinterpret_cast<Bytef*>(out.data()), &size,
                           reinterpret_cast<const Bytef*>(bytes.data()), bytes.size(),
                           Z_DEFAULT_COMPRESSION) == Z_OK);
  out.resize(size);
  return out;
}

/// {"unit","half"} of planes of equal size.
Json packed(const std::vector<std::vector<float>>& planes, int bits = kHalfBits, double least_unit = 1) {
  const double unit = unit_of(planes, least_unit);
  const size_t pixels = planes[0].size();
  std::string bytes(2 * planes.size() * pixels, '\0');
  for (size_t c = 0; c < planes.size(); ++c)
    for (size_t p = 0; p < pixels; ++p) {
      const uint16_t half = half_bits(planes[c][p] / unit, bits);
      bytes[2 * c * pixels + p] = static_cast<char>(half & 0xff);
      bytes[(2 * c + 1) * pixels + p] = static_cast<char>(half >> 8);
    }
  return {{"unit", unit}, {"half", base64(deflate(bytes))}};
}

}  // namespace

std::string base64(std::string_view bytes) {
  static constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (size_t i = 0; i < bytes.size(); i += 3) {
    const size_t count = std::min<size_t>(3, bytes.size() - i);
    uint32_t word = 0;
    for (size_t k = 0; k < 3; ++k) word = word << 8 | (k < count ? static_cast<uint8_t>(bytes[i + k]) : 0u);
    for (size_t k = 0; k < 4; ++k) text += k <= count ? kDigits[word >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

Json image_json(const FilmImage& image, const FilmImage* reference) {
  const Reduction reduce(image.window);
  std::vector<std::vector<float>> rgb;
  for (size_t c = 0; c < 3; ++c) rgb.push_back(reduce.plane([&](size_t p) { return image.rgb[3 * p + c]; }));
  Json json = packed(rgb);
  json["width"] = reduce.width;
  json["height"] = reduce.height;
  json["scale"] = reduce.scale;
  json["x0"] = image.window.x0;
  json["y0"] = image.window.y0;
  json["x1"] = image.window.x1;
  json["y1"] = image.window.y1;
  Json layers = Json::object();
  if (!image.cost.empty())
    layers["cost"] = packed({reduce.plane([&](size_t p) { return image.cost[p]; })}, kHeatBits);
  if (!image.samples.empty())
    layers["samples"] = packed({reduce.plane([&](size_t p) { return image.samples[p]; })});
  if (!image.variance.empty()) {
    const std::vector<float> noise = own_error_pixels(image);
    layers["noise"] = packed({reduce.plane([&](size_t p) { return noise[p]; })}, kHeatBits);
  }
  if (reference != nullptr && reduce.scale > 1) {
    PENUMBRA_CHECK(reference->window == image.window);
    const auto error = [&](size_t p) { return relative_error(image, *reference, p); };
    // Tabulated, not only looked at: all bits, and small errors are no subnormal halves.
    layers["error"] = packed({reduce.plane(error)}, kHalfBits, kErrorUnit);
  }
  json["layers"] = std::move(layers);
  return json;
}

}  // namespace penumbra
