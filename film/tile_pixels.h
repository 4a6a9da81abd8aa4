#pragma once
// What a worker hands back for one mix of a tile task, and what the assembler merges.
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "proto/job.h"

namespace penumbra {

/// Means and M2 of one mix over one tile and one range of passes. Arrays are row-major over the rect,
/// mean and m2 with three channels per pixel (R G B).
struct TilePixels {
  PixelRect rect;
  int64_t passes = 0;         ///< weight: the same for every pixel
  int64_t groups = 0;         ///< independent groups among them
  std::vector<float> mean;    ///< 3 per pixel
  std::vector<float> m2;      ///< 3 per pixel: sum of weight * (group mean - mean)^2
  std::vector<float> cost;    ///< CPU µs per pixel, summed over the passes; outside bit-identity
};

/// All mixes of one tile task.
struct TileResult {
  std::vector<TilePixels> mixes;
};

/// Bytes of a result (little-endian, versioned, with the lengths checked on the way back).
std::string serialize(const TileResult& result);
/// InvalidArgument for bytes that are not a result, whose shapes disagree, or with a non-finite value.
absl::StatusOr<TileResult> parse_tile_result(std::string_view bytes);

}  // namespace penumbra
