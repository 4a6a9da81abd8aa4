#pragma once
#include <vector>

#include "film/film_image.h"

namespace penumbra {

/// What own_error(image) averages: one value per pixel of the window, mean over channels of v/(R²+ε), v the
/// variance layer and R the image's mean over 5×5 pixels. Requires the layer.
std::vector<float> own_error_pixels(const FilmImage& image);

}  // namespace penumbra
