#include "worker/textures/image_file.h"

#include <OpenImageIO/imageio.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/textures/temporary_scene.h"
#include "worker/textures/cie.h"

namespace penumbra {
namespace {

template <class T>
void write_image(const std::string& path, int width, int height, int channels, OIIO::TypeDesc format,
                 const std::vector<T>& values) {
  auto out = OIIO::ImageOutput::create(path);
  ASSERT_TRUE(out) << path;
  ASSERT_TRUE(out->open(path, OIIO::ImageSpec(width, height, channels, format)));
  ASSERT_TRUE(out->write_image(OIIO::BaseTypeFromC<T>::value, values.data()));
  out->close();
}

float srgb(float v) {
  return std::pow((v + 0.055f) / 1.055f, 2.4f);
}

class ImageFile : public testing::Test {
 protected:
  TemporaryScene scene_;
};

TEST_F(ImageFile, EightBitIsSrgbUnlessToldOtherwise) {
  for (const char* name : {"a.png", "a.tga"}) {
    write_image<uint8_t>(scene_.path(name), 1, 1, 3, OIIO::TypeDesc::UINT8, {255, 128, 0});
    const auto automatic = read_image(scene_.path(name), false, {});
    ASSERT_TRUE(automatic.ok()) << automatic.status();
    EXPECT_THAT(automatic->values,
                testing::Pointwise(testing::FloatNear(1e-6f), {1.0f, srgb(128 / 255.f), 0.0f}));
    const auto linear = read_image(scene_.path(name), false, {Encoding::kLinear});
    EXPECT_THAT(linear->values, testing::Pointwise(testing::FloatNear(1e-6f), {1.0f, 128 / 255.f, 0.0f}));
    const auto gamma = read_image(scene_.path(name), false, {Encoding::kGamma, 2});
    EXPECT_NEAR(gamma->values[1], std::pow(128 / 255.f, 2.0f), 1e-6f);
  }
}

TEST_F(ImageFile, FloatFilesAreLinear) {
  for (const char* name : {"a.exr", "a.hdr"}) {
    write_image<float>(scene_.path(name), 1, 1, 3, OIIO::TypeDesc::FLOAT, {8, 0.5f, 0.25f});
    const auto texels = read_image(scene_.path(name), false, {});
    ASSERT_TRUE(texels.ok()) << texels.status();
    EXPECT_THAT(texels->values, testing::Pointwise(testing::FloatNear(0.02f), {8.0f, 0.5f, 0.25f})) << name;
  }
}

TEST_F(ImageFile, RowsRunFromTheTop) {
  write_image<float>(scene_.path("a.exr"), 1, 2, 1, OIIO::TypeDesc::FLOAT, {1, 2});
  const auto texels = read_image(scene_.path("a.exr"), false, {});
  EXPECT_EQ(texels->channels, 1);
  EXPECT_THAT(texels->values, testing::ElementsAre(1, 2));
}

// pbrt-v3 takes the luminance of the stored numbers, then decodes.
TEST_F(ImageFile, GreyIsTheDecodedLuminanceOfTheStoredNumbers) {
  write_image<uint8_t>(scene_.path("a.png"), 1, 1, 3, OIIO::TypeDesc::UINT8, {200, 100, 50});
  const auto texels = read_image(scene_.path("a.png"), true, {});
  ASSERT_EQ(texels->values.size(), 1u);
  EXPECT_NEAR(texels->values[0], srgb(luminance(Rgb(200 / 255.f, 100 / 255.f, 50 / 255.f))), 1e-5f);
}

TEST_F(ImageFile, AlphaIsDroppedNotMultiplied) {
  write_image<uint8_t>(scene_.path("a.png"), 1, 1, 4, OIIO::TypeDesc::UINT8, {255, 128, 64, 0});
  const auto texels = read_image(scene_.path("a.png"), false, {Encoding::kLinear});
  EXPECT_THAT(texels->values, testing::Pointwise(testing::FloatNear(1e-6f), {1.0f, 128 / 255.f, 64 / 255.f}));
}

TEST_F(ImageFile, WhatIsNoImageIsNotFound) {
  scene_.write("a.png", "not a picture");
  EXPECT_EQ(read_image(scene_.path("a.png"), false, {}).status().code(), absl::StatusCode::kNotFound);
  EXPECT_EQ(read_image(scene_.path("b.png"), false, {}).status().code(), absl::StatusCode::kNotFound);
}

TEST_F(ImageFile, ValuesMustBeFinite) {
  write_image<float>(scene_.path("a.exr"), 1, 1, 1, OIIO::TypeDesc::FLOAT, {std::nanf("")});
  EXPECT_EQ(read_image(scene_.path("a.exr"), true, {}).status().code(), absl::StatusCode::kInvalidArgument);
}

}  // namespace
}  // namespace penumbra
