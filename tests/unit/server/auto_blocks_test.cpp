#include "server/auto_blocks.h"

#include <gtest/gtest.h>

#include <cmath>

#include "proto/blocks.h"

namespace penumbra {
namespace {

const PixelRect kTile{0, 0, 32, 32};  // 4 × 4 blocks

/// Blocks of 64 pixels with this deviation in each.
std::vector<BlockCost> blocks(float deviation, float seconds) {
  return std::vector<BlockCost>(16, {64 * deviation, seconds});
}

TEST(AutoBlocks, FollowTheErrorPerSecond) {
  std::vector<BlockCost> measured = blocks(1, 1);
  // The upper half has a ninth of the variance: a third of the passes, but for what neighbours and mean say.
  for (size_t b = 0; b < 8; ++b) measured[b].relative_deviation = 64 / 3.f;
  const SharedOut out = shared_out(kTile, measured);
  ASSERT_EQ(out.shares.size(), 16u);
  EXPECT_EQ(out.shares[15], kWholeShare);
  EXPECT_NEAR(out.shares[0], kWholeShare * std::sqrt((0.8 / 9 + 0.2 * 5 / 9) / (0.8 + 0.2 * 5 / 9)), 2);
  EXPECT_GT(out.shares[4], out.shares[0]) << "a block beside a noisy one";
}

TEST(AutoBlocks, APassCostsAndLeavesWhatItsBlocksDo) {
  std::vector<BlockCost> measured = blocks(1, 1);
  for (size_t b = 0; b < 8; ++b) measured[b] = {64 * 0.3f, 2};
  const SharedOut out = shared_out(kTile, measured);
  ASSERT_FALSE(out.shares.empty());
  EXPECT_GT(out.error, 1);
  EXPECT_LT(out.cost, 1);
  EXPECT_LT(out.error * out.cost, 1) << "no gain";
  double cost = 0;
  for (size_t b = 0; b < 16; ++b) cost += (b < 8 ? 2.0 : 1.0) * out.shares[b] / kWholeShare / 24;
  EXPECT_NEAR(out.cost, cost, 0.05);  // but for the smoothing
}

TEST(AutoBlocks, NoBlockIsLeftAlone) {
  std::vector<BlockCost> measured = blocks(0, 1);
  measured[15].relative_deviation = 64;
  for (const uint8_t share : shared_out(kTile, measured).shares) EXPECT_GE(share, kWholeShare / 4);
}

TEST(AutoBlocks, NothingIsSharedOutForNothing) {
  EXPECT_TRUE(shared_out(kTile, blocks(1, 1)).shares.empty());
  EXPECT_TRUE(shared_out(kTile, blocks(0, 1)).shares.empty()) << "nothing varies";
  EXPECT_TRUE(shared_out(kTile, blocks(1, 0)).shares.empty()) << "nothing took time";
  EXPECT_TRUE(shared_out(kTile, {}).shares.empty()) << "nothing was measured";
  EXPECT_EQ(shared_out(kTile, {}).error, 1);
  EXPECT_EQ(shared_out(kTile, {}).cost, 1);
}

}  // namespace
}  // namespace penumbra
