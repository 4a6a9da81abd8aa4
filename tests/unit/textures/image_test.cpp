#include "worker/textures/image.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "worker/textures/downsample.h"

namespace penumbra {
namespace {

const Vec2f kPoint(0, 0);

Texels grey(int width, int height, std::vector<float> values) {
  return {width, height, 1, std::move(values)};
}

float at(const Image& image, float s, float t, Wrap wrap = Wrap::kRepeat, Filter filter = Filter::kBilinear) {
  return image.lookup({s, t}, kPoint, kPoint, {wrap, filter}).x;
}

TEST(Image, OriginIsTheLowerLeftCorner) {
  const Image image(grey(2, 2,
                         {1, 2,  // the upper row
                          3, 4}));
  EXPECT_EQ(at(image, 0.25f, 0.25f), 3);
  EXPECT_EQ(at(image, 0.75f, 0.25f), 4);
  EXPECT_EQ(at(image, 0.25f, 0.75f), 1);
  EXPECT_EQ(at(image, 0.75f, 0.75f), 2);
}

TEST(Image, BilinearBetweenTexelCentres) {
  const Image image(grey(2, 1, {0, 1}));
  EXPECT_FLOAT_EQ(at(image, 0.5f, 0.5f), 0.5f);
  EXPECT_FLOAT_EQ(at(image, 0.375f, 0.5f), 0.25f);
}

TEST(Image, WrapModes) {
  const Image image(grey(2, 1, {1, 3}));
  EXPECT_EQ(at(image, 0, 0.5f, Wrap::kRepeat), 2);  // half of the last, half of the first
  EXPECT_EQ(at(image, 0, 0.5f, Wrap::kClamp), 1);
  EXPECT_EQ(at(image, 0, 0.5f, Wrap::kBlack), 0.5f);
  EXPECT_EQ(at(image, 5.25f, -7.5f, Wrap::kRepeat), 1);
  EXPECT_EQ(at(image, -0.75f, 0.5f, Wrap::kRepeat), 1);
  EXPECT_EQ(at(image, 7, 0.5f, Wrap::kClamp), 3);
  EXPECT_EQ(at(image, -7, 0.5f, Wrap::kBlack), 0);
}

TEST(Image, CoordinatesOfAnySizeAreSafe) {
  const Image image(grey(3, 3, {1, 1, 1, 1, 1, 1, 1, 1, 1}));
  const float huge = std::numeric_limits<float>::max(), infinite = std::numeric_limits<float>::infinity();
  for (const float s : {huge, -huge, infinite, -infinite, std::nanf("")}) {
    for (const Filter filter : {Filter::kPoint, Filter::kBilinear, Filter::kTrilinear, Filter::kEwa}) {
      EXPECT_EQ(image.lookup({s, s}, {s, 0}, {0, s}, {Wrap::kClamp, filter}).x, 1);
      EXPECT_EQ(image.lookup({s, 0}, {s, s}, {1, s}, {Wrap::kRepeat, filter}).x, 1);
    }
  }
}

TEST(Image, GreyGivesGreyAndColourGivesColour) {
  EXPECT_EQ(Image(grey(1, 1, {0.25f})).lookup({0, 0}, kPoint, kPoint, {}), Rgb(0.25f));
  EXPECT_EQ(Image({1, 1, 3, {0.25f, 0.5f, 1}}).lookup({0, 0}, kPoint, kPoint, {}), Rgb(0.25f, 0.5f, 1));
}

TEST(Image, ValuesBeyondHalfAreKept) {
  const Image image(grey(1, 1, {1e6f}));
  EXPECT_EQ(at(image, 0.5f, 0.5f), 1e6f);
}

TEST(Downsample, EveryLevelHasTheMeanOfTheImage) {
  for (const auto& [width, height] : {std::pair{8, 8}, {7, 5}, {3, 1}, {1, 9}, {13, 6}}) {
    Texels texels = grey(width, height, {});
    double mean = 0;
    for (int i = 0; i < width * height; ++i) {
      texels.values.push_back(static_cast<float>((i * 37) % 101));
      mean += texels.values.back();
    }
    mean /= width * height;
    while (texels.width > 1 || texels.height > 1) {
      texels = halved(texels);
      double sum = 0;
      for (const float v : texels.values) sum += v;
      EXPECT_NEAR(sum / texels.values.size(), mean, 1e-4 * mean)
          << width << "x" << height << " at " << texels.width;
    }
  }
}

/// Columns alternate between 0 and 1.
Image stripes(int size) {
  Texels texels = grey(size, size, {});
  for (int i = 0; i < size * size; ++i) texels.values.push_back(static_cast<float>(i % size % 2));
  return Image(std::move(texels));
}

TEST(Image, AFootprintOfManyTexelsSeesTheMean) {
  const Image image = stripes(64);
  EXPECT_EQ(image.levels(), 7);
  for (const Filter filter : {Filter::kTrilinear, Filter::kEwa}) {
    EXPECT_NEAR(image.lookup({0.3f, 0.6f}, {0.25f, 0}, {0, 0.25f}, {Wrap::kRepeat, filter}).x, 0.5f, 1e-3f);
    EXPECT_NEAR(image.lookup({0.3f, 0.6f}, {9, 0}, {0, 9}, {Wrap::kRepeat, filter}).x, 0.5f, 1e-3f);
  }
}

TEST(Image, TrilinearBlursBothAxesAndEwaOnlyTheLongOne) {
  const Image image = stripes(64);
  const Vec2f st(0.5f / 64 + 1.0f / 64, 0.5f), along_stripes(0, 4.0f / 64), across(0.25f / 64, 0);
  const Rgb blurred = image.lookup(st, across, along_stripes, {Wrap::kRepeat, Filter::kTrilinear});
  const Rgb sharp = image.lookup(st, across, along_stripes, {Wrap::kRepeat, Filter::kEwa, 64});
  EXPECT_NEAR(blurred.x, 0.5f, 0.01f);
  EXPECT_GT(sharp.x, 0.8f);
  // The same footprint turned by a quarter averages the stripes.
  EXPECT_NEAR(image.lookup(st, {4.0f / 64, 0}, {0, 0.25f / 64}, {Wrap::kRepeat, Filter::kEwa, 64}).x, 0.5f,
              0.05f);
}

TEST(Image, EwaOfALinearRampIsTheRamp) {
  constexpr int kSize = 64;
  Texels texels = grey(kSize, kSize, {});
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x)
      texels.values.push_back((x + 0.5f) / kSize + 2 * (kSize - y - 0.5f) / kSize);
  }
  const Image image(std::move(texels));
  const Vec2f dx(0.05f, 0.02f), dy(-0.01f, 0.04f);
  const float value = image.lookup({0.4f, 0.55f}, dx, dy, {Wrap::kClamp, Filter::kEwa}).x;
  EXPECT_NEAR(value, 0.4f + 2 * 0.55f, 2e-3f);
}

}  // namespace
}  // namespace penumbra
