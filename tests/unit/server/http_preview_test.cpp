#include "server/http_preview.h"

#include <gtest/gtest.h>
#include <zlib.h>

#include "film/png.h"

namespace penumbra {
namespace {

uint32_t word(const std::string& bytes, size_t at) {
  uint32_t v = 0;
  for (size_t i = 0; i < 4; ++i) v = v << 8 | static_cast<uint8_t>(bytes[at + i]);
  return v;
}

struct Decoded {
  uint32_t width = 0, height = 0;
  std::string rows;  ///< filter byte, then RGB
};

/// Reads what png_bytes() writes: every chunk's CRC, one IDAT.
Decoded decode(const std::string& file) {
  Decoded out;
  EXPECT_EQ(file.substr(0, 8), "\x89PNG\r\n\x1a\n");
  for (size_t at = 8; at < file.size(); at += 12 + word(file, at)) {
    const uint32_t length = word(file, at);
    const std::string body = file.substr(at + 4, 4 + length), data = body.substr(4);
    EXPECT_EQ(word(file, at + 8 + length), crc32(0, reinterpret_cast<const Bytef*>(body.data()), 4 + length));
    if (body.starts_with("IHDR")) {
      out.width = word(data, 0);
      out.height = word(data, 4);
      EXPECT_EQ(data.substr(8), std::string("\x08\x02\0\0\0", 5));
    } else if (body.starts_with("IDAT")) {
      uLongf size = (3 * out.width + 1) * out.height;
      out.rows.resize(size);
      EXPECT_EQ(uncompress(reinterpret_cast<Bytef*>(out.rows.data()), &size,
                           reinterpret_cast<const Bytef*>(data.data()), length),
                Z_OK);
    } else {
      EXPECT_EQ(body, "IEND");
    }
  }
  return out;
}

FilmImage constant(int width, int height, float value) {
  FilmImage image;
  image.width = width;
  image.height = height;
  image.window = {0, 0, width, height};
  image.rgb.assign(3 * image.pixels(), value);
  return image;
}

TEST(Png, HoldsTheBytes) {
  const Decoded d = decode(png_bytes(2, 2, {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 255}, PngEffort::kQuick));
  EXPECT_EQ(d.width, 2u);
  EXPECT_EQ(d.height, 2u);
  EXPECT_EQ(d.rows, std::string("\0\x01\x02\x03\x04\x05\x06\0\x07\x08\x09\x0a\x0b\xff", 14));
}

TEST(Preview, IsSrgbOfTheExposedImage) {
  FilmImage image = constant(4, 3, 0.5f);
  image.rgb[0] = 100;
  image.rgb[1] = -1;
  const double exposure = preview_exposure(image);
  EXPECT_NEAR(exposure, 1.4, 1e-6);
  const Decoded d = decode(preview_png(image, exposure));
  EXPECT_EQ(static_cast<uint8_t>(d.rows[1]), 255);
  EXPECT_EQ(static_cast<uint8_t>(d.rows[2]), 0);
  EXPECT_EQ(static_cast<uint8_t>(d.rows[3]), 218);  // 255 (1.055·0.7^(1/2.4) - 0.055) = 217.8
}

TEST(Preview, LargeImagesAreAveraged) {
  const Decoded d = decode(preview_png(constant(kPreviewEdge + 1, 3, 1), 1));
  EXPECT_EQ(d.width, static_cast<uint32_t>(kPreviewEdge / 2 + 1));
  EXPECT_EQ(d.height, 2u);
}

TEST(Preview, WhatHasNoSamplesIsNeitherBlackNorWeighed) {
  FilmImage image = constant(4, 1, 0);
  image.samples = {0, 0, 0, 4};
  for (size_t c = 0; c < 3; ++c) image.rgb[9 + c] = 0.5f;
  EXPECT_NEAR(preview_exposure(image), 1.4, 1e-6);
  const Decoded d = decode(preview_png(image, 1.4));
  EXPECT_GT(static_cast<uint8_t>(d.rows[1]), 0);
  EXPECT_EQ(static_cast<uint8_t>(d.rows[10]), 218);
}

TEST(Preview, ABlackImageHasAnExposure) {
  EXPECT_EQ(preview_exposure(constant(2, 2, 0)), 1);
}

}  // namespace
}  // namespace penumbra
