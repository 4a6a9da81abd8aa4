#include "proto/blocks.h"

#include <gtest/gtest.h>

namespace penumbra {
namespace {

TEST(Blocks, CoverTheTileOnce) {
  const PixelRect tile{5, 7, 5 + 19, 7 + 9};  // 3 × 2 blocks, those at the edges smaller
  ASSERT_EQ(block_count(tile), 6u);
  int64_t area = 0;
  for (size_t b = 0; b < block_count(tile); ++b) {
    const PixelRect block = block_rect(tile, b);
    area += block.area();
    for (int y = block.y0; y < block.y1; ++y)
      for (int x = block.x0; x < block.x1; ++x) EXPECT_EQ(block_of(tile, x, y), b);
  }
  EXPECT_EQ(area, tile.area());
}

TEST(Blocks, SitOutWholeGroupsEvenly) {
  for (const int64_t group : {1, 2, 8})
    for (const int share : {1, 64, 100, 128, 254, kWholeShare}) {
      int64_t own = 0;
      for (int64_t pass = 0; pass < 600 * group; ++pass) {
        EXPECT_EQ(passes_of_block(pass, share, group), own);
        const int64_t next = passes_of_block(pass + 1, share, group);
        ASSERT_TRUE(next == own || next == own + 1);
        if (pass % group != 0) {
          EXPECT_EQ(next - own, passes_of_block(pass, share, group) - passes_of_block(pass - 1, share, group))
              << "a group is cut in two";
        }
        own = next;
        const double fair = static_cast<double>((pass + 1) * share) / kWholeShare;
        EXPECT_LT(std::abs(static_cast<double>(own) - fair), static_cast<double>(group) + 1e-9);
      }
      EXPECT_EQ(passes_of_block(group, share, group), group) << "the first group is everybody's";
    }
  EXPECT_EQ(passes_of_block(1'000'000'000'007, kWholeShare, 8), 1'000'000'000'007);
}

TEST(Blocks, TheMeanShareIsOverPixels) {
  const PixelRect tile{0, 0, 12, 8};  // blocks of 64 and 32 pixels
  EXPECT_EQ(mean_share(tile, {}), 1);
  EXPECT_DOUBLE_EQ(mean_share(tile, {kWholeShare, 51}), (64 + 32 * 0.2) / 96);
  EXPECT_EQ(block_passes_sum(tile, {}, 4, 10), 960);
  EXPECT_EQ(block_passes_sum(tile, {kWholeShare, 51}, 4, 16),
            16 * 64 + 4 * 32);  // floor(4 · 0.2 + 1 − 0.1) groups of 4
  EXPECT_TRUE(shares_fit(tile, {}));
  EXPECT_TRUE(shares_fit(tile, {1, 255}));
  EXPECT_FALSE(shares_fit(tile, {1, 0}));
  EXPECT_FALSE(shares_fit(tile, {1}));
}

}  // namespace
}  // namespace penumbra
