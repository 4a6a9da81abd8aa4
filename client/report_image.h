#pragma once
// Images as the report's page carries them.
#include <string>
#include <string_view>

#include "client/job_json.h"
#include "film/film_image.h"

namespace penumbra {

/// An image for the page:
/// {"width","height","scale","x0","y0","x1","y1","unit","half":"…","layers":{NAME:{"unit","half"}}}. `half`
/// is base64 of zlib of half floats in multiples of `unit`: of all R, then all G, then all B; of each plane
/// first the low bytes, then the high bytes (they compress better apart). `unit` is a power of two, 1 unless
/// a value is beyond the largest half. Layers, one plane each, those that the image has: `cost` (CPU µs),
/// `samples` (passes) and `noise`, what the run expects of each pixel's relative squared error, mean over
/// channels of v/(I²+ε); cost and noise to seven bits, for false colours. Images of more than 2^20 pixels are
/// averaged over scale × scale pixels; x0 … y1 are pixels of the full image.
///
/// With a `reference`, which covers the same pixels, an averaged image also has the layer `error`: means of
/// the full image's relative squared errors. Averages have lost their noise, so the page cannot make it.
Json image_json(const FilmImage& image, const FilmImage* reference = nullptr);

std::string base64(std::string_view bytes);

}  // namespace penumbra
