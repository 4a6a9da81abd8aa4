#include "client/report_data.h"

#include <half.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "client/run_json.h"
#include "film/exr.h"
#include "proto/status.h"

namespace penumbra {
namespace {

namespace fs = std::filesystem;

// A page with five images of this size stays near 20 MB.
constexpr int64_t kMostPixels = int64_t{1} << 20;

/// The part of an image inside `window`, which lies in the image's own.
FilmImage cut(const FilmImage& image, const PixelRect& window) {
  FilmImage part;
  part.width = image.width;
  part.height = image.height;
  part.window = window;
  part.rgb.reserve(3 * part.pixels());
  for (int y = window.y0; y < window.y1; ++y) {
    const auto row = image.rgb.begin() + static_cast<std::ptrdiff_t>(3 * image.index(window.x0, y));
    part.rgb.insert(part.rgb.end(), row, row + 3 * static_cast<std::ptrdiff_t>(window.width()));
  }
  return part;
}

struct Reduced {
  int width = 0, height = 0, scale = 1;
  std::vector<float> rgb;
};

/// Means over scale × scale pixels; those at the right and bottom edge over what there is.
Reduced reduce(const FilmImage& image) {
  Reduced out;
  const double excess = static_cast<double>(image.window.area()) / static_cast<double>(kMostPixels);
  out.scale = std::max(1, static_cast<int>(std::ceil(std::sqrt(excess))));
  const int width = image.window.width(), height = image.window.height();
  out.width = (width + out.scale - 1) / out.scale;
  out.height = (height + out.scale - 1) / out.scale;
  for (int y = 0; y < out.height; ++y)
    for (int x = 0; x < out.width; ++x) {
      const PixelRect block{x * out.scale, y * out.scale, std::min((x + 1) * out.scale, width),
                            std::min((y + 1) * out.scale, height)};
      double sum[3] = {0, 0, 0};
      for (int j = block.y0; j < block.y1; ++j)
        for (int i = block.x0; i < block.x1; ++i)
          for (size_t c = 0; c < 3; ++c)
            sum[c] += image.rgb[3 * image.index(image.window.x0 + i, image.window.y0 + j) + c];
      for (const double s : sum) out.rgb.push_back(static_cast<float>(s / static_cast<double>(block.area())));
    }
  return out;
}

std::string half_planes(const std::vector<float>& rgb) {
  const size_t pixels = rgb.size() / 3;
  std::string bytes(6 * pixels, '\0');
  for (size_t c = 0; c < 3; ++c)
    for (size_t p = 0; p < pixels; ++p) {
      const uint16_t bits = Imath::half(rgb[3 * p + c]).bits();
      bytes[2 * c * pixels + p] = static_cast<char>(bits & 0xff);
      bytes[(2 * c + 1) * pixels + p] = static_cast<char>(bits >> 8);
    }
  return bytes;
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

/// The image if it is there and covers `window` (empty: whatever it covers).
absl::StatusOr<FilmImage> read_part(const std::string& path, const std::optional<PixelRect>& window) {
  ASSIGN_OR_RETURN(const FilmImage image, read_exr(path));
  if (!window) return cut(image, image.window);
  if (!contains(image.window, *window)) return invalid_input("{}: does not cover the rendered pixels", path);
  return cut(image, *window);
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

Json image_json(const FilmImage& image) {
  const Reduced reduced = reduce(image);
  return {{"width", reduced.width}, {"height", reduced.height},
          {"scale", reduced.scale}, {"x0", image.window.x0},
          {"y0", image.window.y0},  {"half", base64(deflate(half_planes(reduced.rgb)))}};
}

absl::StatusOr<Json> report_data(const std::string& folder) {
  const fs::path base = folder;
  ASSIGN_OR_RETURN(Json run, read_json(base / "run.json"));
  if (!run.is_object() || run.value("schema", 0) != 1 || !run.contains("mixes") || !run["mixes"].is_array())
    return invalid_input("{}: not a run.json of schema 1", (base / "run.json").string());
  Json images = Json::array(), notes = Json::array();
  std::optional<PixelRect> window;
  try {
    for (const Json& mix : run["mixes"]) {
      const absl::StatusOr<FilmImage> image = read_part(base / mix.at("image").get<std::string>(), window);
      images.push_back(image.ok() ? image_json(*image) : Json(nullptr));
      if (image.ok())
        window = image->window;
      else
        notes.push_back(message_of(image.status()));
    }
    Json reference;
    if (window && run.contains("reference") && run["reference"].is_string()) {
      const absl::StatusOr<FilmImage> image = read_part(run["reference"].get<std::string>(), window);
      if (image.ok())
        reference = image_json(*image);
      else
        notes.push_back("reference: " + message_of(image.status()));
    }
    return Json{{"run", std::move(run)},
                {"images", std::move(images)},
                {"reference", std::move(reference)},
                {"notes", std::move(notes)}};
  } catch (const Json::exception& fault) {
    return invalid_input("{}: {}", (base / "run.json").string(), fault.what());
  }
}

}  // namespace penumbra
