#pragma once
// A small picture of a sky, for tests of light from infinitely far.
#include <gtest/gtest.h>

#include <filesystem>
#include <tuple>
#include <vector>

#include "film/film_image.h"

namespace penumbra::test {

/// Writes a dim map with some texels (x, y) of a brightness of their own.
inline void write_sky_map(const std::filesystem::path& path, int width, int height,
                          const std::vector<std::tuple<int, int, float>>& bright) {
  FilmImage map;
  map.width = width;
  map.height = height;
  map.window = {0, 0, width, height};
  for (int i = 0; i < width * height; ++i)
    for (int c = 0; c < 3; ++c)
      map.rgb.push_back(0.2f + 0.1f * float(c) + 0.3f * float((i / width + i % width) % 4));
  for (const auto& [x, y, value] : bright)
    for (size_t c = 0; c < 3; ++c) map.rgb[3 * (size_t(y) * size_t(width) + size_t(x)) + c] = value;
  ASSERT_TRUE(write_exr(path, map, {}).ok());
}

}  // namespace penumbra::test
