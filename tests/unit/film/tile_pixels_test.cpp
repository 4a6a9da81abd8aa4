#include "film/tile_pixels.h"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>

#include "proto/status.h"

namespace penumbra {
namespace {

TilePixels sample_tile() {
  TilePixels p;
  p.rect = {64, 128, 67, 130};
  p.passes = 8;
  p.groups = 2;
  for (int i = 0; i < 18; ++i) {
    p.mean.push_back(0.1f * static_cast<float>(i));
    p.m2.push_back(0.01f * static_cast<float>(i));
  }
  for (int i = 0; i < 6; ++i) p.cost.push_back(static_cast<float>(i));
  return p;
}

TileResult sample_result() {
  TilePixels empty;
  empty.rect = {64, 128, 67, 130};
  return {{sample_tile(), empty}};
}

std::vector<float> copy(std::span<const float> values) {
  return {values.begin(), values.end()};
}

TEST(TileResult, RoundTrips) {
  const TileResult result = sample_result();
  const auto back = ReceivedTile::parse(serialize(result));
  ASSERT_TRUE(back.ok()) << message_of(back.status());
  ASSERT_EQ(back->mixes().size(), 2u);
  EXPECT_EQ(back->mixes()[0].rect, result.mixes[0].rect);
  EXPECT_EQ(back->mixes()[0].passes, 8);
  EXPECT_EQ(back->mixes()[0].groups, 2);
  EXPECT_EQ(copy(back->mixes()[0].mean), result.mixes[0].mean);
  EXPECT_EQ(copy(back->mixes()[0].m2), result.mixes[0].m2);
  EXPECT_EQ(copy(back->mixes()[0].cost), result.mixes[0].cost);
  EXPECT_EQ(back->mixes()[1].passes, 0);
  EXPECT_TRUE(back->mixes()[1].mean.empty());
}

TilePixels blocks_tile() {
  TilePixels p = sample_tile();
  p.rect = {64, 128, 74, 129};  // two blocks of 8 and 2 pixels
  p.mean.resize(30);
  p.m2.resize(30);
  p.cost.resize(10);
  p.block_passes = {8, 4};
  p.block_groups = {2, 1};
  return p;
}

TEST(TileResult, CountsOfBlocksComeBack) {
  const auto back = ReceivedTile::parse(serialize({{blocks_tile(), sample_tile()}}));
  ASSERT_TRUE(back.ok()) << message_of(back.status());
  const TileView& p = back->mixes()[0];
  EXPECT_EQ(p.counts_at(71, 128), (std::pair<int64_t, int64_t>{8, 2}));
  EXPECT_EQ(p.counts_at(72, 128), (std::pair<int64_t, int64_t>{4, 1}));
  EXPECT_EQ(back->mixes()[1].counts_at(66, 129), (std::pair<int64_t, int64_t>{8, 2}));
  EXPECT_EQ(copy(back->mixes()[1].mean), sample_tile().mean);
}

TEST(TileResult, CountsOfBlocksMustFit) {
  const auto fault = [](auto break_it) {
    TilePixels p = blocks_tile();
    break_it(p);
    return fault_of(p);
  };
  EXPECT_TRUE(fault([](TilePixels&) {}).empty());
  EXPECT_FALSE(fault([](TilePixels& p) { p.block_passes[0] = 9; }).empty()) << "more than the range has";
  EXPECT_FALSE(fault([](TilePixels& p) { p.block_passes[0] = -1; }).empty());
  EXPECT_FALSE(fault([](TilePixels& p) { p.block_groups[1] = 5; }).empty()) << "more groups than passes";
  EXPECT_FALSE(fault([](TilePixels& p) { p.block_groups[1] = 0; }).empty()) << "passes without a group";
  EXPECT_FALSE(fault([](TilePixels& p) { p.block_passes.pop_back(); }).empty());
  EXPECT_FALSE(fault([](TilePixels& p) {
                 p.block_passes.pop_back();
                 p.block_groups.pop_back();
               }).empty());
}

TEST(TileResult, ResultsFromBeforeThereWereBlocksAreRead) {
  std::string bytes = serialize({{sample_tile()}});
  bytes[4] = 1;             // the version
  bytes.erase(12 + 32, 8);  // the numbers of blocks and bins, behind rect, passes and groups
  const auto back = ReceivedTile::parse(bytes);
  ASSERT_TRUE(back.ok()) << message_of(back.status());
  EXPECT_EQ(copy(back->mixes()[0].mean), sample_tile().mean);
}

TEST(TileResult, ResultsFromBeforeThereWereBinsAreRead) {
  std::string bytes = serialize({{sample_tile()}});
  bytes[4] = 2;
  bytes.erase(12 + 36, 4);
  const auto back = ReceivedTile::parse(bytes);
  ASSERT_TRUE(back.ok()) << message_of(back.status());
  EXPECT_EQ(back->mixes()[0].bins, 0);
  EXPECT_EQ(copy(back->mixes()[0].mean), sample_tile().mean);
}

TilePixels binned_tile() {
  TilePixels p = sample_tile();
  p.bins = 2;
  for (int i = 0; i < 36; ++i) {
    p.bin_mean.push_back(static_cast<float>(i));
    p.bin_m2.push_back(0.5f * static_cast<float>(i));
  }
  return p;
}

TEST(TileResult, BinsComeBack) {
  const auto back = ReceivedTile::parse(serialize({{binned_tile(), sample_tile()}}));
  ASSERT_TRUE(back.ok()) << message_of(back.status());
  const TileView second = back->mixes()[0].bin(1);
  EXPECT_EQ(back->mixes()[0].bins, 2);
  EXPECT_EQ(second.mean.size(), 18u);
  EXPECT_EQ(second.mean[0], 18);
  EXPECT_EQ(second.m2[17], 17.5f);
  EXPECT_EQ(second.passes, 8);
  EXPECT_EQ(second.groups, 2);
  EXPECT_TRUE(second.cost.empty());
  EXPECT_EQ(back->mixes()[1].bins, 0);
}

TEST(TileResult, BinsMustFit) {
  const auto fault = [](auto break_it) {
    TilePixels p = binned_tile();
    break_it(p);
    return fault_of(p);
  };
  EXPECT_TRUE(fault([](TilePixels&) {}).empty());
  EXPECT_FALSE(fault([](TilePixels& p) { p.bins = 3; }).empty());
  EXPECT_FALSE(fault([](TilePixels& p) { p.bin_m2.pop_back(); }).empty());
  EXPECT_FALSE(fault([](TilePixels& p) { p.bin_m2[3] = -1; }).empty());
  EXPECT_FALSE(fault([](TilePixels& p) { p.bin_mean[3] = std::numeric_limits<float>::infinity(); }).empty());
}

TEST(TileResult, AMixWithoutPassesIsNotSent) {
  TilePixels zeros = sample_tile();
  zeros.passes = zeros.groups = 0;
  const std::string bytes = serialize({{zeros}});
  const auto back = ReceivedTile::parse(bytes);
  ASSERT_TRUE(back.ok()) << message_of(back.status());
  EXPECT_TRUE(back->mixes()[0].mean.empty());
  EXPECT_LT(bytes.size(), 64u);
}

TEST(TileResult, NothingRoundTrips) {
  const auto back = ReceivedTile::parse(serialize(TileResult{}));
  ASSERT_TRUE(back.ok());
  EXPECT_TRUE(back->mixes().empty());
}

TEST(TileResult, EveryTruncationIsRefused) {
  const std::string bytes = serialize(sample_result());
  for (size_t n = 0; n < bytes.size(); ++n) EXPECT_FALSE(ReceivedTile::parse(bytes.substr(0, n)).ok()) << n;
  std::string longer = bytes;
  longer.push_back('\0');
  EXPECT_FALSE(ReceivedTile::parse(longer).ok());
}

/// Byte offset of the first mix's fields: after magic, version and count.
constexpr size_t kFirstMix = 12;

template <class Number>
std::string with(size_t offset, Number value) {
  std::string bytes = serialize(sample_result());
  std::memcpy(bytes.data() + offset, &value, sizeof value);
  return bytes;
}

TEST(TileResult, LiesAreRefused) {
  EXPECT_FALSE(ReceivedTile::parse(with<char>(0, 'X')).ok());
  EXPECT_FALSE(ReceivedTile::parse(with<uint32_t>(4, 4)).ok()) << "version";
  EXPECT_FALSE(ReceivedTile::parse(with<uint32_t>(8, 0xffffffff)).ok()) << "number of mixes";
  EXPECT_FALSE(ReceivedTile::parse(with<int32_t>(kFirstMix, -1)).ok()) << "x0";
  EXPECT_FALSE(ReceivedTile::parse(with<int32_t>(kFirstMix + 8, 64)).ok()) << "empty rect";
  EXPECT_FALSE(ReceivedTile::parse(with<int32_t>(kFirstMix + 8, 0x7fffffff)).ok()) << "huge rect";
  EXPECT_FALSE(ReceivedTile::parse(with<int64_t>(kFirstMix + 16, -8)).ok()) << "passes";
  EXPECT_FALSE(ReceivedTile::parse(with<int64_t>(kFirstMix + 24, 0)).ok()) << "no group";
  EXPECT_FALSE(ReceivedTile::parse(with<int64_t>(kFirstMix + 24, 9)).ok()) << "more groups than passes";
  EXPECT_FALSE(ReceivedTile::parse(with<uint32_t>(kFirstMix + 32, 0xffffffff)).ok()) << "number of blocks";
  EXPECT_FALSE(ReceivedTile::parse(with<uint32_t>(kFirstMix + 36, 0xffffffff)).ok()) << "number of bins";
}

TEST(TileResult, NothingNonFiniteEnters) {
  const size_t mean = kFirstMix + 40, m2 = mean + 18 * 4, cost = m2 + 18 * 4;
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()})
    for (const size_t place : {mean, m2, cost + 5 * 4})
      EXPECT_FALSE(ReceivedTile::parse(with(place, bad)).ok());
  EXPECT_FALSE(ReceivedTile::parse(with(m2, -1.0f)).ok());
  EXPECT_FALSE(ReceivedTile::parse(with(cost, -1.0f)).ok());
  EXPECT_TRUE(ReceivedTile::parse(with(mean, -1.0f)).ok());
}

TEST(TileResultDeathTest, WrongShapeIsAProgrammersFault) {
  TileResult result{{sample_tile()}};
  result.mixes[0].m2.pop_back();
  EXPECT_DEATH(serialize(result), "fault_of");
}

}  // namespace
}  // namespace penumbra
