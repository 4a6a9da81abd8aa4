#include "proto/tiles.h"

#include <algorithm>

namespace penumbra {

std::vector<PixelRect> tiles_of(const JobSpec& spec) {
  std::vector<PixelRect> tiles;
  for (int y = spec.crop.y0; y < spec.crop.y1; y += spec.tile)
    for (int x = spec.crop.x0; x < spec.crop.x1; x += spec.tile)
      tiles.push_back({x, y, std::min(x + spec.tile, spec.crop.x1), std::min(y + spec.tile, spec.crop.y1)});
  return tiles;
}

uint64_t tile_count(const JobSpec& spec) {
  const auto tile = static_cast<uint64_t>(spec.tile);
  const auto along = [&](int pixels) { return (static_cast<uint64_t>(pixels) + tile - 1) / tile; };
  return along(spec.crop.width()) * along(spec.crop.height());
}

}  // namespace penumbra
