#pragma once
#include <vector>

#include "proto/job.h"

namespace penumbra {

/// The job's tiles, row by row from the crop's upper left corner; those at the right and bottom edges may
/// be smaller.
std::vector<PixelRect> tiles_of(const JobSpec& spec);

}  // namespace penumbra
