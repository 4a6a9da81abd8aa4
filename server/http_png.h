#pragma once
#include <cstdint>
#include <string>
#include <vector>

namespace penumbra {

/// A PNG (ISO 15948) of 8-bit RGB rows, top first. `rgb` holds 3 · width · height bytes.
std::string png(int width, int height, const std::vector<uint8_t>& rgb);

}  // namespace penumbra
