#pragma once
// Image files (PNG, TGA, EXR, HDR, PFM, JPEG, …) to linear values. The only includer of OpenImageIO here.
#include <string>

#include "absl/status/statusor.h"
#include "worker/textures/image.h"

namespace penumbra {

/// How a file's numbers encode linear values: v = decode(stored).
struct Encoding {
  enum Kind { kAutomatic, kLinear, kSrgb, kGamma } kind = kAutomatic;  ///< kAutomatic: sRGB for integers
  float gamma = 1;                                                     ///< kGamma: v = stored^gamma
  bool operator==(const Encoding&) const = default;
};

/// Reads the first image of a file. `grey`: one channel, the Rec. 709 luminance of the stored numbers (as
/// pbrt-v3 takes float textures), else three. Alpha is dropped, not multiplied. NotFound if the file cannot
/// be read as an image; InvalidArgument for values that are not finite.
absl::StatusOr<Texels> read_image(const std::string& path, bool grey, const Encoding& encoding);

}  // namespace penumbra
