#pragma once
#include <cstdint>
#include <string>
#include <vector>

namespace penumbra {

/// A small file, or one that is made quickly (a preview).
enum class PngEffort { kSmall, kQuick };

/// Bytes of a PNG file (8-bit RGB, ISO/IEC 15948); `rgb` is row-major, 3 per pixel.
std::string png_bytes(int width, int height, const std::vector<uint8_t>& rgb,
                      PngEffort effort = PngEffort::kSmall);

}  // namespace penumbra
