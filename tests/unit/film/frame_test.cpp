#include "film/frame.h"

#include <gtest/gtest.h>

#include <cmath>

#include "film/moments.h"

namespace penumbra {
namespace {

/// A tile whose values are distinct functions of pixel and channel.
TilePixels tile(const PixelRect& rect, int64_t passes, int64_t groups, float value) {
  TilePixels p;
  p.rect = rect;
  p.passes = passes;
  p.groups = groups;
  for (int y = rect.y0; y < rect.y1; ++y)
    for (int x = rect.x0; x < rect.x1; ++x) {
      for (int c = 0; c < 3; ++c) {
        p.mean.push_back(value + static_cast<float>(100 * y + 10 * x + c));
        p.m2.push_back(groups > 1 ? 1.0f : 0.0f);
      }
      p.cost.push_back(2);
    }
  return p;
}

TEST(Frame, TilesLandAtTheirPixels) {
  Frame frame(10, 8, {2, 1, 7, 6});
  merge(frame, tile({2, 1, 4, 3}, 4, 2, 0));
  merge(frame, tile({4, 1, 7, 6}, 4, 2, 0));
  const FilmImage image = resolve(frame);
  EXPECT_EQ(image.width, 10);
  EXPECT_EQ(image.window, (PixelRect{2, 1, 7, 6}));
  for (int y = 1; y < 6; ++y)
    for (int x = 2; x < 7; ++x) {
      const bool covered = x >= 4 || y < 3;
      const size_t i = image.index(x, y);
      EXPECT_EQ(image.rgb[3 * i + 2], covered ? static_cast<float>(100 * y + 10 * x + 2) : 0.0f);
      EXPECT_EQ(image.samples[i], covered ? 4.0f : 0.0f);
      EXPECT_EQ(image.cost[i], covered ? 2.0f : 0.0f);
      // m2 = 1, two groups, four passes: 1 / ((2 - 1) 4).
      EXPECT_EQ(image.variance[3 * i], covered ? 0.25f : 0.0f);
    }
}

TEST(Frame, BlocksCountForThemselves) {
  Frame frame(16, 1, {0, 0, 16, 1});
  TilePixels first = tile({0, 0, 16, 1}, 8, 2, 1), second = tile({0, 0, 16, 1}, 4, 1, 4);
  second.block_passes = {4, 0};
  second.block_groups = {1, 0};
  merge(frame, first);
  merge(frame, second);
  const FilmImage image = resolve(frame);
  EXPECT_EQ(image.samples[0], 12);
  EXPECT_EQ(image.samples[15], 8);
  EXPECT_FLOAT_EQ(image.rgb[0], 2);             // (8 · 1 + 4 · 4) / 12
  EXPECT_FLOAT_EQ(image.rgb[45], 1 + 10 * 15);  // as before
  EXPECT_FLOAT_EQ(image.variance[45], 1.f / 8);
}

TEST(Frame, PassesAccumulateAsMoments) {
  Frame frame(2, 1, {0, 0, 2, 1});
  merge(frame, tile({0, 0, 2, 1}, 4, 2, 1));
  merge(frame, tile({0, 0, 2, 1}, 12, 3, 3));
  Moments expected{2, 4, 1, 1};
  expected.merge({3, 12, 3, 1});
  const FilmImage image = resolve(frame);
  EXPECT_EQ(image.rgb[0], static_cast<float>(expected.mean));
  EXPECT_FLOAT_EQ(image.rgb[0], 2.5f);
  EXPECT_EQ(image.variance[0], static_cast<float>(expected.variance_of_mean()));
  EXPECT_EQ(image.samples[1], 16);
  EXPECT_EQ(image.cost[1], 4);
}

TEST(Frame, AMixWithoutPassesLeavesNoTrace) {
  Frame frame(2, 1, {0, 0, 2, 1});
  TilePixels nothing;
  nothing.rect = {0, 0, 2, 1};
  merge(frame, nothing);
  EXPECT_EQ(resolve(frame).samples[0], 0);
}

TEST(Frame, MergeOrderDecidesTheBitsAndOnlyIt) {
  const auto a = tile({0, 0, 1, 1}, 3, 1, 0.1f), b = tile({0, 0, 1, 1}, 5, 2, 0.7f);
  Frame once(1, 1, {0, 0, 1, 1}), twice(1, 1, {0, 0, 1, 1});
  for (Frame* f : {&once, &twice}) {
    merge(*f, a);
    merge(*f, b);
  }
  EXPECT_EQ(once.mean, twice.mean);
  EXPECT_EQ(once.m2, twice.m2);
}

TEST(FrameDeathTest, ATileOutsideTheCropIsAProgrammersFault) {
  Frame frame(4, 4, {0, 0, 2, 2});
  EXPECT_DEATH(merge(frame, tile({1, 1, 3, 2}, 1, 1, 0)), "contains");
}

TEST(Rectangles, IntersectAndContain) {
  EXPECT_EQ(intersect({0, 0, 4, 4}, {2, 3, 9, 9}), (PixelRect{2, 3, 4, 4}));
  EXPECT_EQ(intersect({0, 0, 2, 2}, {5, 5, 6, 6}).area(), 0);
  EXPECT_TRUE(contains({0, 0, 4, 4}, {0, 0, 4, 4}));
  EXPECT_FALSE(contains({0, 0, 4, 4}, {0, 0, 5, 4}));
}

}  // namespace
}  // namespace penumbra
