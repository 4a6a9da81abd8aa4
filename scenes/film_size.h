#pragma once
#include "absl/status/status.h"
#include "scenes/diagnostics.h"

namespace penumbra {

/// Pixels across and down that a film asks for; pbrt's default of its version where it says nothing
/// (v3 "image": 640×480, v4: 1280×720).
struct FilmSize {
  int64_t width = 0, height = 0;
};
FilmSize film_size(const Entity& film);

/// InvalidArgument for a side that is not in [1, 65536] or more than 2^28 pixels.
absl::Status check_film(const Entity& film, const Diagnostics& diagnostics);

}  // namespace penumbra
