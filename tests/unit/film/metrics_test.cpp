#include "film/metrics.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "proto/status.h"

namespace penumbra {
namespace {

using testing::HasSubstr;

FilmImage constant(int width, int height, float value) {
  FilmImage image;
  image.width = width;
  image.height = height;
  image.window = {0, 0, width, height};
  image.rgb.assign(3 * image.pixels(), value);
  return image;
}

TEST(Compare, FollowsTheFormula) {
  FilmImage image = constant(40, 20, 2), reference = constant(40, 20, 1);
  reference.variance.assign(reference.rgb.size(), 0.04f);
  const auto e = compare(image, reference);
  ASSERT_TRUE(e.ok());
  EXPECT_NEAR(e->relmse, 1 / 1.01, 1e-12);
  EXPECT_NEAR(e->mse, 1, 1e-12);
  EXPECT_NEAR(*e->reference_floor, 0.04 / 1.01, 1e-8);
  EXPECT_NEAR(e->trimmed_relmse, 1 / 1.01, 1e-12);
  ASSERT_TRUE(e->relmse_ci.has_value());
  EXPECT_NEAR(e->relmse_ci->low, e->relmse, 1e-12);
  EXPECT_NEAR(e->relmse_ci->high, e->relmse, 1e-12);
  EXPECT_EQ(e->region, (PixelRect{0, 0, 40, 20}));
}

TEST(Compare, WithoutNoiseOfTheReferenceThereIsNoFloor) {
  const auto e = compare(constant(4, 4, 1), constant(4, 4, 1));
  ASSERT_TRUE(e.ok());
  EXPECT_EQ(e->relmse, 0);
  EXPECT_FALSE(e->reference_floor.has_value());
  EXPECT_FALSE(e->relmse_ci.has_value()) << "nothing differs";
}

TEST(Compare, SaysWhatTheImagesOwnVarianceWouldShow) {
  FilmImage image = constant(40, 20, 2), reference = constant(40, 20, 1);
  EXPECT_FALSE(compare(image, reference)->variance.has_value());
  EXPECT_TRUE(compare(image, reference)->blocks.variance.empty());
  image.variance.assign(image.rgb.size(), 0.04f);
  for (size_t i = 0; i < 3 * 40 * 4; ++i) image.variance[i] = 0.08f;  // rows 0 to 3
  const auto e = compare(image, reference);
  ASSERT_TRUE(e.ok());
  EXPECT_NEAR(*e->variance, (0.08 * 4 + 0.04 * 16) / 20 / 1.01, 1e-8);
  ASSERT_EQ(e->blocks.variance.size(), e->blocks.relmse.size());
  EXPECT_NEAR(e->blocks.variance.front(), 0.08 / 1.01, 1e-8);
  EXPECT_NEAR(e->blocks.variance.back(), 0.04 / 1.01, 1e-8);
}

TEST(Compare, TrimsTheWorstThousandth) {
  FilmImage image = constant(100, 20, 1);
  const FilmImage reference = constant(100, 20, 1);
  image.rgb[3 * 77] = 1001;  // two pixels of 2000 may go
  image.rgb[3 * 78] = 1001;
  image.rgb[3 * 79] = 1.5f;
  const auto e = compare(image, reference);
  ASSERT_TRUE(e.ok());
  EXPECT_NEAR(e->trimmed_relmse, 0.25 / 1.01 / 3 / 1998, 1e-12);
  EXPECT_NEAR(e->relmse, (2e6 + 0.25) / 1.01 / 3 / 2000, 1e-6);
}

TEST(Compare, RegionsAreHalfOpen) {
  FilmImage image = constant(40, 40, 1);
  const FilmImage reference = constant(40, 40, 1);
  image.rgb[3 * image.index(10, 20)] = 2;
  EXPECT_GT(compare(image, reference, PixelRect{10, 20, 11, 21})->relmse, 0);
  EXPECT_EQ(compare(image, reference, PixelRect{0, 0, 10, 40})->relmse, 0);
  EXPECT_EQ(compare(image, reference, PixelRect{10, 0, 11, 20})->relmse, 0);
}

TEST(Compare, ACropIsComparedWhereItIs) {
  FilmImage image = constant(10, 10, 1), reference = constant(10, 10, 0);
  image.window = {4, 4, 6, 6};
  image.rgb.assign(12, 1);
  for (int y = 4; y < 6; ++y)
    for (int x = 4; x < 6; ++x)
      for (size_t c = 0; c < 3; ++c) reference.rgb[3 * reference.index(x, y) + c] = 1;
  EXPECT_EQ(compare(image, reference)->relmse, 0);
  EXPECT_THAT(message_of(compare(image, reference, PixelRect{0, 0, 5, 5}).status()),
              HasSubstr("not in the image, which covers 4,4,6,6"));
}

TEST(Compare, SaysWhereTheErrorIs) {
  FilmImage image = constant(20, 9, 1);
  const FilmImage reference = constant(20, 9, 1);
  for (size_t c = 0; c < 3; ++c) image.rgb[3 * image.index(18, 8) + c] = 2;
  const auto e = compare(image, reference);
  ASSERT_TRUE(e.ok());
  EXPECT_EQ(e->blocks.edge, 4);
  ASSERT_EQ(e->blocks.relmse.size(), 15u);
  EXPECT_NEAR(e->blocks.relmse[14], 1 / 1.01 / 4, 1e-9) << "one of the corner block's 4 × 1 pixels";
  EXPECT_EQ(e->blocks.relmse[13], 0);
  const auto large = compare(constant(640, 360, 2), constant(640, 360, 1));
  EXPECT_EQ(large->blocks.edge, 16);
  EXPECT_EQ(large->blocks.relmse.size(), 920u);
}

TEST(Compare, RefusesWhatCannotBeCompared) {
  FilmImage image = constant(10, 10, 1);
  EXPECT_THAT(message_of(compare(image, constant(10, 11, 1)).status()),
              HasSubstr("10x10, the reference 10x11"));
  EXPECT_THAT(message_of(compare(image, image, PixelRect{3, 3, 3, 5}).status()), HasSubstr("is empty"));
  FilmImage broken = image;
  broken.rgb[3 * broken.index(7, 2) + 1] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THAT(message_of(compare(broken, image).status()),
              HasSubstr("1 pixels that are not finite, the first at 7,2"));
  EXPECT_TRUE(compare(broken, image, PixelRect{0, 3, 10, 10}).ok()) << "the fault is elsewhere";
}

TEST(Compare, TheIntervalCoversTheTruthAndIsRepeatable) {
  // Independent noise of equal strength in each pixel: the truth is known, 0.01 / 1.01.
  const FilmImage reference = constant(64, 64, 1);
  int covered = 0;
  constexpr int kTrials = 200;
  for (unsigned t = 0; t < kTrials; ++t) {
    std::mt19937 random(t);
    std::normal_distribution<float> noise(0, 0.1f);
    FilmImage image = reference;
    for (float& v : image.rgb) v += noise(random);
    const auto e = compare(image, reference);
    ASSERT_TRUE(e.ok());
    EXPECT_EQ(e->relmse_ci, compare(image, reference)->relmse_ci);
    covered += e->relmse_ci->low <= 0.01 / 1.01 && 0.01 / 1.01 <= e->relmse_ci->high;
  }
  EXPECT_GE(covered, 180) << "95 %, less three standard deviations of 200 trials";
  EXPECT_LT(covered, kTrials);
}

}  // namespace
}  // namespace penumbra
