// Any bytes as a tile's result: an error, or pixels without a fault whose bytes are the same again (but for
// the version: those from before there were blocks or bins are written as today's).
#include <cstddef>

#include "film/tile_pixels.h"
#include "proto/status.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t count) {
  const std::string text(reinterpret_cast<const char*>(bytes), count);
  const auto tile = penumbra::ReceivedTile::parse(text);
  if (!tile.ok()) return 0;
  penumbra::TileResult copy;
  for (const penumbra::TileView& mix : tile->mixes()) {
    PENUMBRA_CHECK(penumbra::fault_of(mix).empty());
    copy.mixes.push_back({mix.rect,
                          mix.passes,
                          mix.groups,
                          {mix.block_passes.begin(), mix.block_passes.end()},
                          {mix.block_groups.begin(), mix.block_groups.end()},
                          {mix.mean.begin(), mix.mean.end()},
                          {mix.m2.begin(), mix.m2.end()},
                          {mix.cost.begin(), mix.cost.end()},
                          mix.bins,
                          {mix.bin_mean.begin(), mix.bin_mean.end()},
                          {mix.bin_m2.begin(), mix.bin_m2.end()}});
  }
  constexpr size_t kVersionAt = 4;
  if (text[kVersionAt] == 3) PENUMBRA_CHECK(penumbra::serialize(copy) == text);
  return 0;
}
