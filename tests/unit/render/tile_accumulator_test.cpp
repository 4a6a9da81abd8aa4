#include "worker/render/tile_accumulator.h"

#include <gtest/gtest.h>

#include <cmath>

namespace penumbra {
namespace {

TEST(TileAccumulator, MeansAndDeviationsOfGroups) {
  TileAccumulator tile({0, 0, 1, 1}, 2);
  const float values[] = {1, 3, 5, 7, 9};  // groups of 2 passes: means 2 and 6, and a lone 9
  for (int pass = 0; pass < 5; ++pass) {
    tile.add(0, Rgb(values[pass], 2 * values[pass], 0), 10);
    tile.end_pass(pass, 1e-3);
  }
  tile.finish();
  const TilePixels p = tile.pixels();
  EXPECT_EQ(p.passes, 5);
  EXPECT_EQ(p.groups, 3);
  EXPECT_FLOAT_EQ(p.mean[0], 5);
  EXPECT_FLOAT_EQ(p.mean[1], 10);
  // Σ weight (group mean − 5)² = 2·9 + 2·1 + 1·16.
  EXPECT_FLOAT_EQ(p.m2[0], 36);
  EXPECT_FLOAT_EQ(p.cost[0], 5000);
}

TEST(TileAccumulator, SpreadsAPassOverPixelsByTicks) {
  TileAccumulator tile({0, 0, 2, 1}, 1);
  tile.add(0, Rgb(0), 30);
  tile.add(1, Rgb(0), 10);
  tile.end_pass(0, 4e-6);
  tile.finish();
  EXPECT_FLOAT_EQ(tile.pixels().cost[0], 3);
  EXPECT_FLOAT_EQ(tile.pixels().cost[1], 1);
}

TEST(TileAccumulator, GroupsAreCountedFromTheRunsFirstPass) {
  TileAccumulator tile({0, 0, 1, 1}, 4);
  for (int pass = 2; pass < 6; ++pass) {  // a range that begins within a group
    tile.add(0, Rgb(1), 1);
    tile.end_pass(pass, 0);
  }
  tile.finish();
  EXPECT_EQ(tile.pixels().groups, 2);
}

TEST(TileAccumulator, BlocksThatSitOutHaveCountsOfTheirOwn) {
  TileAccumulator tile({0, 0, 9, 1}, 2);  // blocks of 8 pixels and of 1
  for (int pass = 0; pass < 4; ++pass) {
    for (size_t pixel = 0; pixel < 9; ++pixel)
      if (pixel < 8 || pass < 2) tile.add(pixel, Rgb(pixel < 8 ? 1.f : float(pass)), 10);
    tile.end_pass(pass, pass < 2 ? 9e-6 : 8e-6);
  }
  tile.finish();
  const TilePixels p = tile.pixels();
  EXPECT_EQ(p.passes, 4);
  EXPECT_EQ(p.groups, 2);
  EXPECT_EQ(p.block_passes, (std::vector<int32_t>{4, 2}));
  EXPECT_EQ(p.block_groups, (std::vector<int32_t>{2, 1}));
  EXPECT_FLOAT_EQ(p.mean[24], 0.5);
  EXPECT_FLOAT_EQ(p.cost[8], 2) << "charged for passes that it sat out";
  EXPECT_FLOAT_EQ(p.cost[0], 4);
  EXPECT_TRUE(fault_of(p).empty());
}

TEST(TileAccumulator, BlocksAddUp) {
  TileAccumulator tile({0, 0, 16, 1}, 1);
  for (int pass = 0; pass < 3; ++pass) {
    for (size_t pixel = 0; pixel < 16; ++pixel)
      tile.add(pixel, Rgb(pixel < 8 ? 1.f : float(pass)), pixel < 8 ? 10 : 30);
    tile.end_pass(pass, 4e-6);
  }
  const std::vector<BlockCost> blocks = tile.blocks();
  ASSERT_EQ(blocks.size(), 2u);
  EXPECT_EQ(blocks[0].relative_deviation, 0);
  EXPECT_NEAR(blocks[1].relative_deviation, 8 * std::sqrt(3 / 1.01),
              1e-3);  // s² = 1 about the mean 1, three times
  EXPECT_FLOAT_EQ(blocks[0].cpu_seconds, 1e-6f);
  EXPECT_FLOAT_EQ(blocks[1].cpu_seconds, 3e-6f);
}

TEST(TileAccumulator, RelativeVarianceNeedsTwoPasses) {
  TileAccumulator tile({0, 0, 1, 1}, 1);
  tile.add(0, Rgb(1), 1);
  tile.end_pass(0, 0);
  EXPECT_EQ(tile.relative_variance(), 0);
  tile.add(0, Rgb(3), 1);
  tile.end_pass(1, 0);
  EXPECT_NEAR(tile.relative_variance(), 3 * 2.0 / (4 + 1e-2), 1e-9);
}

}  // namespace
}  // namespace penumbra
