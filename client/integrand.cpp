#include "client/integrand.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <map>

#include "film/atomic_file.h"
#include "film/exr.h"
#include "film/png.h"
#include "proto/status.h"

namespace penumbra {
namespace {

constexpr size_t kMostParts = 256;  // mixes of a job

double grey(const FilmImage& image, size_t pixel) {
  const float* v = &image.rgb[3 * pixel];
  return (double{v[0]} + v[1] + v[2]) / 3;
}

std::string name_of(const StrategyCount& strategy) {
  Mix alone;
  alone.strategies = {strategy};
  const std::string text = label(alone);
  return text.substr(0, text.find(':'));
}

/// Dark blue, violet, orange, yellow: luminance rises all the way.
std::array<uint8_t, 3> colour(double t) {
  constexpr double kStops[5][3] = {{0, 0, 0}, {50, 20, 120}, {180, 50, 110}, {245, 140, 40}, {255, 250, 170}};
  const double at = std::clamp(t, 0.0, 1.0) * 4;
  const auto stop = std::min<size_t>(3, static_cast<size_t>(at));
  std::array<uint8_t, 3> out{};
  for (size_t c = 0; c < 3; ++c)
    out[c] = static_cast<uint8_t>(std::lround(kStops[stop][c] + (kStops[stop + 1][c] - kStops[stop][c]) *
                                                                    (at - static_cast<double>(stop))));
  return out;
}

/// A file's name as a relative URL: "#" of a repeated mix would begin a fragment.
std::string url_of(const std::string& name) {
  constexpr std::string_view kPlain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-._~";
  std::string url;
  for (const char c : name)
    url += kPlain.find(c) != std::string_view::npos ? std::string(1, c)
                                                    : fmt::format("%{:02X}", static_cast<unsigned char>(c));
  return url;
}

std::string page(const std::string& figures) {
  return "<!doctype html><html lang=\"en\"><meta charset=\"utf-8\"><title>Integrands</title><style>"
         "body{font-family:sans-serif;margin:2em}figure{display:inline-block;margin:1em}"
         "img{width:320px;image-rendering:pixelated;display:block}figcaption{max-width:320px}</style>"
         "<h1>w·f/p over the light</h1><p>Left to right along the light's edge u, top to bottom along v. One "
         "scale for each mix, from 0 (black) to its largest value (yellow). The flatter a picture, the less "
         "variance its samples have.</p>\n" +
         figures + "</html>\n";
}

}  // namespace

absl::StatusOr<IntegrandJob> integrand_job(const JobSpec& picture, int x, int y, int light, int grid) {
  if (x < 0 || y < 0 || x >= picture.width || y >= picture.height)
    return invalid_input("--pixel: {},{} is not in the image, which is {}x{}", x, y, picture.width,
                         picture.height);
  IntegrandJob job;
  job.spec = picture;
  Probe probe{Probe::Kind::kIntegrand, picture.width, picture.height, x, y, light, {}};
  job.spec.mixes.clear();
  const std::vector<std::string> names = labels(picture.mixes);
  for (size_t m = 0; m < names.size(); ++m) {
    const Mix& mix = picture.mixes[m];
    if (mix.automatic) return invalid_input("--mix: auto has no strategies of its own; name a mix");
    if (mix.combination == Combination::kAverage || mix.combination == Combination::kFree)
      return invalid_input("--mix: {}: --integrand draws mixes of /balance, /power and /smooth", names[m]);
    for (size_t s = 0; s < mix.strategies.size(); ++s) {
      job.spec.mixes.push_back(mix);
      probe.slots.push_back(static_cast<int>(s));
      const std::string strategy = name_of(mix.strategies[s]);
      job.parts.push_back({names[m], strategy, file_stem(names[m]) + "." + file_stem(strategy)});
    }
  }
  if (job.parts.size() > kMostParts)
    return invalid_input("--mix: {} strategies in all are more than {}", job.parts.size(), kMostParts);
  job.spec.probe = probe;
  job.spec.width = job.spec.height = grid;
  job.spec.crop = {0, 0, grid, grid};
  job.spec.budget = SppBudget{1};
  job.spec.plan.clear();
  job.spec.reference.clear();
  job.spec.regions.clear();
  return job;
}

IntegrandFigures figures_of(const FilmImage& image) {
  IntegrandFigures out;
  const auto n = static_cast<double>(image.pixels());
  double squares = 0;
  for (size_t p = 0; p < image.pixels(); ++p) {
    const double v = grey(image, p);
    out.mean += v / n;
    squares += v * v / n;
    out.largest = std::max(out.largest, v);
    out.lit += v > 0 ? 1 / n : 0;
  }
  if (out.mean > 0) out.variation = std::sqrt(std::max(0.0, squares - out.mean * out.mean)) / out.mean;
  return out;
}

std::string integrand_png(const FilmImage& image, double largest) {
  std::vector<uint8_t> rgb;
  rgb.reserve(3 * image.pixels());
  for (size_t p = 0; p < image.pixels(); ++p)
    for (const uint8_t byte : colour(largest > 0 ? grey(image, p) / largest : 0)) rgb.push_back(byte);
  return png_bytes(image.window.width(), image.window.height(), rgb);
}

absl::StatusOr<Json> write_integrands(const IntegrandJob& job, const std::vector<FilmImage>& images,
                                      const std::string& folder) {
  PENUMBRA_CHECK(images.size() == job.parts.size());
  const std::filesystem::path base = folder;
  std::map<std::string, double> largest;  // of a mix
  for (size_t i = 0; i < images.size(); ++i)
    largest[job.parts[i].mix] = std::max(largest[job.parts[i].mix], figures_of(images[i]).largest);
  Json json = Json::array();
  std::string figures;
  for (size_t i = 0; i < images.size(); ++i) {
    const IntegrandPart& part = job.parts[i];
    const IntegrandFigures f = figures_of(images[i]);
    RETURN_IF_ERROR(write_exr(base / (part.stem + ".exr"), images[i],
                              {part.mix + " " + part.strategy, 0, job.spec.scene, job.spec.seed, false}));
    RETURN_IF_ERROR(
        write_file_atomically(base / (part.stem + ".png"), integrand_png(images[i], largest[part.mix])));
    json.push_back({{"mix", part.mix},
                    {"strategy", part.strategy},
                    {"image", part.stem + ".exr"},
                    {"mean", f.mean},
                    {"largest", f.largest},
                    {"lit", f.lit},
                    {"variation", f.variation}});
    figures += fmt::format(
        "<figure><img src=\"{0}\" alt=\"w·f/p of {1} in {2}\"><figcaption><b>{1}</b> in {2}<br>mean "
        "{3:.4g}, "
        "largest {4:.4g}, variation {5:.3g}</figcaption></figure>\n",
        url_of(part.stem + ".png"), part.strategy, part.mix, f.mean, f.largest, f.variation);
  }
  RETURN_IF_ERROR(write_file_atomically(base / "integrand.html", page(figures)));
  return json;
}

}  // namespace penumbra
