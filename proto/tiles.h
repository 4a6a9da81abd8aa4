#pragma once
#include <cstdint>
#include <vector>

#include "proto/job.h"

namespace penumbra {

/// The job's tiles, row by row from the crop's upper left corner; those at the right and bottom edges may
/// be smaller.
std::vector<PixelRect> tiles_of(const JobSpec& spec);

/// How many these are. More than kMostTiles mean that they are too small for the picture.
uint64_t tile_count(const JobSpec& spec);
inline constexpr uint64_t kMostTiles = uint64_t{1} << 20;

}  // namespace penumbra
