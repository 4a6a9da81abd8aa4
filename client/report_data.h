#pragma once
// What the report's page shows, as one JSON value.
#include <optional>
#include <string>
#include <string_view>

#include "absl/status/statusor.h"
#include "client/job_json.h"
#include "film/film_image.h"

namespace penumbra {

/// An image for the page: {"width","height","scale","x0","y0","half":"…"}. `half` is base64 of zlib of the
/// half floats of all R, then all G, then all B; of each plane first the low bytes, then the high bytes
/// (they compress better apart). Images of more than 2^20 pixels are averaged over scale × scale pixels.
Json image_json(const FilmImage& image);

std::string base64(std::string_view bytes);

/// {"run","images":[…],"reference","notes":[…]}: run.json's content, its images and its reference, the
/// latter over the images' window. What cannot be read is null and a note.
absl::StatusOr<Json> report_data(const std::string& folder);

}  // namespace penumbra
