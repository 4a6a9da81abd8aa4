#include "scenes/film_size.h"

namespace penumbra {
namespace {

constexpr int64_t kLongestSide = 65536;
constexpr int64_t kMostPixels = int64_t{1} << 28;

}  // namespace

FilmSize film_size(const Entity& film) {
  const bool v4 = film.type == "rgb" || film.type == "gbuffer" || film.type == "spectral";
  return {film.params.integer("xresolution", v4 ? 1280 : 640),
          film.params.integer("yresolution", v4 ? 720 : 480)};
}

absl::Status check_film(const Entity& film, const Diagnostics& diagnostics) {
  const FilmSize size = film_size(film);
  for (const auto& [name, side] : {std::pair("xresolution", size.width), {"yresolution", size.height}}) {
    if (side >= 1 && side <= kLongestSide) continue;
    const Param* const param = film.params.find(name);
    return diagnostics.error(param ? param->loc : film.loc, "{} {} is not from 1 to {}", name, side,
                             kLongestSide);
  }
  if (size.width * size.height > kMostPixels)
    return diagnostics.error(film.loc, "{} × {} pixels are more than {}", size.width, size.height,
                             kMostPixels);
  return absl::OkStatus();
}

}  // namespace penumbra
