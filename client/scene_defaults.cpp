#include "client/scene_defaults.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <utility>

#include "client/pointline.h"
#include "film/film_image.h"
#include "proto/status.h"
#include "scenes/film_size.h"

namespace penumbra {
namespace {

// A sample count above this in a scene file is a slip; --spp goes as far.
constexpr int64_t kMostPasses = int64_t{1} << 32;

absl::Status fault(const SceneDescription& scene, const Entity& entity, std::string_view why) {
  return invalid_input("{}: {}", scene.place(entity.loc), why);
}

absl::Status read_film(const SceneDescription& scene, SceneDefaults& out) {
  const Params& p = scene.film.params;
  const auto [width, height] = film_size(scene.film);
  if (width < 1 || height < 1 || width > kMostImageEdge || height > kMostImageEdge ||
      width * height > kMostImagePixels)
    return fault(scene, scene.film, fmt::format("Film: resolution {}x{} is out of range", width, height));
  out.width = static_cast<int>(width);
  out.height = static_cast<int>(height);
  out.film_place = scene.place(scene.film.loc);
  const Param* window = p.find("cropwindow");
  if (window != nullptr && window->numbers.size() == 4)
    out.crop_window = {window->numbers[0], window->numbers[1], window->numbers[2], window->numbers[3]};
  const Param* bounds = p.find("pixelbounds");
  if (bounds != nullptr && bounds->numbers.size() == 4) {
    const auto edge = [&](size_t i) {
      return static_cast<int>(std::clamp(bounds->numbers[i], 0.0, static_cast<double>(kMostImageEdge)));
    };
    out.pixel_bounds = PixelRect{edge(0), edge(2), edge(1), edge(3)};
  }
  return absl::OkStatus();
}

absl::Status read_sampler(const SceneDescription& scene, SceneDefaults& out) {
  const Entity& sampler = scene.sampler;
  const Params& p = sampler.params;
  if (sampler.type == "stratified") {
    const int64_t x = p.integer("xsamples", 4), y = p.integer("ysamples", 4);
    if (x < 1 || y < 1 || x > kMostPasses || y > kMostPasses || x > kMostPasses / y)
      return fault(scene, sampler, fmt::format("Sampler: {} x {} samples is out of range", x, y));
    out.passes = x * y;
    return absl::OkStatus();
  }
  // pbrt's defaults: 4 where samples are independent, 16 elsewhere.
  const int64_t fallback = sampler.type == "random" || sampler.type == "independent" ? 4 : 16;
  out.passes = p.integer("pixelsamples", fallback);
  if (out.passes < 1 || out.passes > kMostPasses)
    return fault(scene, sampler, fmt::format("Sampler: {} samples per pixel is out of range", out.passes));
  return absl::OkStatus();
}

absl::Status read_integrator(const SceneDescription& scene, SceneDefaults& out) {
  const Entity& integrator = scene.integrator;
  const int64_t fallback = integrator.type == "pointline" ? 1 : 5;  // the authors' and pbrt's defaults
  int64_t depth = integrator.params.integer("maxdepth", fallback);
  if (depth < 0) return fault(scene, integrator, fmt::format("Integrator: maxdepth {} is negative", depth));
  if (depth > kMostDepth || depth == 0) {
    const int64_t asked = std::exchange(depth, depth == 0 ? 1 : kMostDepth);
    out.notes.push_back(
        fmt::format("{}: maxdepth {}: rendered with {}", scene.place(integrator.loc), asked, depth));
  }
  out.max_depth = static_cast<int>(depth);
  if (integrator.type != "pointline") return absl::OkStatus();
  ASSIGN_OR_RETURN(out.mix, pointline_mix(scene, out.notes));
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<SceneDefaults> scene_defaults(const SceneDescription& scene) {
  SceneDefaults out;
  RETURN_IF_ERROR(read_film(scene, out));
  RETURN_IF_ERROR(read_sampler(scene, out));
  RETURN_IF_ERROR(read_integrator(scene, out));
  return out;
}

absl::StatusOr<PixelRect> SceneDefaults::crop(int full_width, int full_height) const {
  const PixelRect full{0, 0, full_width, full_height};
  PixelRect rect = full;
  if (crop_window) {
    // pbrt-v3, Film::Film: from ceil(resolution × minimum) to ceil(resolution × maximum); either order.
    const auto [x0, x1, y0, y1] = *crop_window;
    const auto edge = [](double fraction, int size) {
      return static_cast<int>(std::ceil(std::clamp(fraction, 0.0, 1.0) * size));
    };
    rect = {edge(std::min(x0, x1), full_width), edge(std::min(y0, y1), full_height),
            edge(std::max(x0, x1), full_width), edge(std::max(y0, y1), full_height)};
  }
  // Pixel bounds name pixels of the scene's own resolution and mean nothing in another.
  if (pixel_bounds && full_width == width && full_height == height) rect = intersect(rect, *pixel_bounds);
  if (rect.x0 >= rect.x1 || rect.y0 >= rect.y1)
    return invalid_input("{}: Film: the crop leaves no pixel of {}x{}", film_place, full_width, full_height);
  return rect;
}

}  // namespace penumbra
