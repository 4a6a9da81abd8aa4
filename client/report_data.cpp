#include "client/report_data.h"

#include <filesystem>
#include <optional>
#include <vector>

#include "client/flipbook.h"
#include "client/report_image.h"
#include "client/run_json.h"
#include "film/exr.h"
#include "proto/status.h"

namespace penumbra {
namespace {

namespace fs = std::filesystem;

/// The part of an image inside `window`, which lies in the image's own.
FilmImage cut(const FilmImage& image, const PixelRect& window) {
  FilmImage part;
  part.width = image.width;
  part.height = image.height;
  part.window = window;
  const auto copy = [&](const std::vector<float>& from, size_t channels, std::vector<float>& to) {
    if (from.empty()) return;
    to.reserve(channels * part.pixels());
    for (int y = window.y0; y < window.y1; ++y) {
      const auto row = from.begin() + static_cast<std::ptrdiff_t>(channels * image.index(window.x0, y));
      to.insert(to.end(), row, row + static_cast<std::ptrdiff_t>(channels) * window.width());
    }
  };
  copy(image.rgb, 3, part.rgb);
  copy(image.variance, 3, part.variance);
  copy(image.samples, 1, part.samples);
  copy(image.cost, 1, part.cost);
  return part;
}

/// The image if it is there and covers `window` (empty: whatever it covers).
absl::StatusOr<FilmImage> read_part(const std::string& path, const std::optional<PixelRect>& window) {
  ASSIGN_OR_RETURN(const FilmImage image, read_exr(path));
  if (!window) return cut(image, image.window);
  if (!contains(image.window, *window)) return invalid_input("{}: does not cover the rendered pixels", path);
  return cut(image, *window);
}

/// The run's reference over `window`; nothing, and a note, if it cannot be read.
std::optional<FilmImage> reference_over(const Json& run, const PixelRect& window, Json& notes) {
  if (!run.contains("reference") || !run["reference"].is_string()) return std::nullopt;
  absl::StatusOr<FilmImage> image = read_part(run["reference"].get<std::string>(), window);
  if (image.ok()) return *std::move(image);
  notes.push_back("reference: " + message_of(image.status()));
  return std::nullopt;
}

}  // namespace

absl::StatusOr<Json> report_data(const std::string& folder) {
  const fs::path base = folder;
  ASSIGN_OR_RETURN(Json run, read_json(base / "run.json"));
  if (!run.is_object() || run.value("schema", 0) != 1 || !run.contains("mixes") || !run["mixes"].is_array())
    return invalid_input("{}: not a run.json of schema 1", (base / "run.json").string());
  Json images = Json::array(), notes = Json::array();
  // Of the first image that is there: all others and the reference are shown over it.
  std::optional<PixelRect> window;
  std::optional<FilmImage> reference;
  try {
    for (const Json& mix : run["mixes"]) {
      const absl::StatusOr<FilmImage> image = read_part(base / mix.at("image").get<std::string>(), window);
      if (image.ok() && !window) {
        window = image->window;
        reference = reference_over(run, *window, notes);
      }
      images.push_back(image.ok() ? image_json(*image, reference ? &*reference : nullptr) : Json(nullptr));
      if (!image.ok()) notes.push_back(message_of(image.status()));
    }
    std::vector<std::optional<ExrBins>> bins(run["mixes"].size());
    const bool transient = run.contains("transient") && !run["transient"].is_null();
    for (size_t m = 0; transient && m < bins.size(); ++m) {
      absl::StatusOr<ExrBins> read = read_exr_bins(base / run["mixes"][m]["image"].get<std::string>());
      if (read.ok())
        bins[m] = *std::move(read);
      else
        notes.push_back(message_of(read.status()));
    }
    return Json{{"run", std::move(run)},
                {"images", std::move(images)},
                {"reference", reference ? image_json(*reference) : Json(nullptr)},
                {"flipbook", flipbook_json(bins)},
                {"notes", std::move(notes)}};
  } catch (const Json::exception& fault) {
    return invalid_input("{}: {}", (base / "run.json").string(), fault.what());
  }
}

}  // namespace penumbra
