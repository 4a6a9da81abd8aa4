#pragma once
// The interval of every error figure: whole blocks of pixels, drawn again and again.
#include <optional>
#include <vector>

#include "film/statistics.h"

namespace penumbra {

/// Errors of one block of pixels: their sum, and over how many pixels.
struct BlockError {
  double sum = 0;
  double pixels = 0;
};

/// 95 % percentile interval of the ratio sum / pixels under resampling of whole blocks with replacement
/// (2,000 times, a fixed seed: the same blocks give the same interval). Nothing with fewer than two blocks.
std::optional<ConfidenceInterval> bootstrap(const std::vector<BlockError>& blocks);

}  // namespace penumbra
