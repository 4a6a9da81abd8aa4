#include "client/report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <half.h>
#include <unistd.h>
#include <zlib.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>

#include "client/report_data.h"
#include "client/report_image.h"
#include "film/atomic_file.h"
#include "film/exr.h"
#include "proto/status.h"
#include "sample_run.h"

namespace penumbra {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;

FilmImage gradient(int width, int height) {
  FilmImage image;
  image.width = width;
  image.height = height;
  image.window = {0, 0, width, height};
  for (size_t i = 0; i < 3 * image.pixels(); ++i) image.rgb.push_back(static_cast<float>(i));
  return image;
}

std::string content(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::string unbase64(const std::string& text) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  uint32_t word = 0;
  int bits = 0;
  for (const char c : text) {
    if (c == '=') break;
    word = word << 6 | static_cast<uint32_t>(digits.find(c));
    if ((bits += 6) >= 8) bytes += static_cast<char>(word >> (bits -= 8) & 0xff);
  }
  return bytes;
}

TEST(Base64, OfTheStandard) {  // RFC 4648 §10
  EXPECT_EQ(base64(""), "");
  EXPECT_EQ(base64("f"), "Zg==");
  EXPECT_EQ(base64("fo"), "Zm8=");
  EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
  EXPECT_EQ(base64("\xff\xfe\xfd"), "//79");
}

TEST(ImageJson, HoldsEveryPixelAsHalf) {
  const FilmImage image = gradient(5, 3);
  const Json json = image_json(image);
  EXPECT_EQ(json["width"], 5);
  EXPECT_EQ(json["scale"], 1);
  const std::string packed = unbase64(json["half"].get<std::string>());
  std::string bytes(6 * image.pixels(), '\0');
  uLongf size = bytes.size();
  ASSERT_EQ(uncompress(reinterpret_cast<Bytef*>(bytes.data()), &size,
                       reinterpret_cast<const Bytef*>(packed.data()), packed.size()),
            Z_OK);
  ASSERT_EQ(size, bytes.size());
  for (size_t p = 0; p < image.pixels(); ++p)
    for (size_t c = 0; c < 3; ++c) {
      Imath::half value;
      value.setBits(static_cast<uint16_t>(static_cast<uint8_t>(bytes[2 * c * 15 + p]) |
                                          static_cast<uint8_t>(bytes[(2 * c + 1) * 15 + p]) << 8));
      EXPECT_EQ(static_cast<float>(value), image.rgb[3 * p + c]);
    }
}

/// The values of one plane.
std::vector<double> plane(const Json& json, size_t index, size_t count) {
  const std::string text = unbase64(json["half"].get<std::string>());
  std::string bytes((2 * index + 2) * count + 6 * count, '\0');
  uLongf size = bytes.size();
  EXPECT_EQ(uncompress(reinterpret_cast<Bytef*>(bytes.data()), &size,
                       reinterpret_cast<const Bytef*>(text.data()), text.size()),
            Z_OK);
  std::vector<double> values;
  for (size_t p = 0; p < count; ++p) {
    Imath::half value;
    value.setBits(static_cast<uint16_t>(static_cast<uint8_t>(bytes[2 * index * count + p]) |
                                        static_cast<uint8_t>(bytes[(2 * index + 1) * count + p]) << 8));
    values.push_back(json["unit"].get<double>() * static_cast<double>(static_cast<float>(value)));
  }
  return values;
}

TEST(ImageJson, ValuesBeyondHalfHaveAUnit) {
  FilmImage image = gradient(4, 2);
  EXPECT_EQ(image_json(image)["unit"], 1.0);
  image.rgb[3] = 1e6f;
  const Json json = image_json(image);
  EXPECT_EQ(json["unit"], 16.0);
  const std::vector<double> red = plane(json, 0, 8);
  EXPECT_NEAR(red[1] / 1e6, 1, 1e-3);
  EXPECT_NEAR(red[2], 6, 1e-2);
}

TEST(ImageJson, LayersAreThereWhereTheImageHasThem) {
  FilmImage image = gradient(4, 2);
  EXPECT_TRUE(image_json(image)["layers"].empty());
  image.samples.assign(8, 21);
  image.cost = {1, 10, 100, 1000, 10000, 100000, 7, 8};
  image.rgb.assign(24, 2);
  image.variance.assign(24, 0.25f);
  const Json layers = image_json(image)["layers"];
  EXPECT_EQ(plane(layers["samples"], 0, 8), std::vector<double>(8, 21));
  const std::vector<double> cost = plane(layers["cost"], 0, 8), noise = plane(layers["noise"], 0, 8);
  for (size_t p = 0; p < 8; ++p) {
    EXPECT_NEAR(cost[p] / image.cost[p], 1, 1.0 / 256) << "seven stored bits";
    EXPECT_NEAR(noise[p] / (0.25 / 4.01), 1, 1.0 / 256);
  }
}

TEST(ImageJson, ErrorsOfLargeImagesAreTakenBeforeTheyAreAveraged) {
  FilmImage image = gradient(2049, 1024), reference = image;
  for (size_t i = 0; i < image.rgb.size(); ++i) {
    reference.rgb[i] = 2;
    // Around the reference, so that each 2×2 pixels average to it: by 1/16 in the left half, by 1/1024
    // elsewhere.
    const size_t x = i / 3 % 2049, y = i / 3 / 2049;
    image.rgb[i] = 2 + ((x + y) % 2 == 0 ? 1.f : -1.f) * (x < 1024 ? 1.f / 16 : 1.f / 1024);
  }
  const Json layers = image_json(image, &reference)["layers"];
  const std::vector<double> error = plane(layers["error"], 0, size_t{1025} * 512);
  EXPECT_NEAR(error[0] / (1.0 / 256 / 4.01), 1, 1e-3);
  EXPECT_NEAR(error[1023] / (1.0 / 1048576 / 4.01), 1, 1e-3) << "small errors keep their digits";
  EXPECT_NEAR(error[1024] / (1.0 / 1048576 / 4.01), 1, 1e-3) << "the last column is one pixel wide";
}

TEST(ImageJson, ThePageMakesErrorsOfSmallImagesItself) {
  const FilmImage image = gradient(4, 2);
  EXPECT_FALSE(image_json(image, &image)["layers"].contains("error"));
}

TEST(ImageJson, LargeImagesAreAveraged) {
  const Json json = image_json(gradient(2049, 1024));
  EXPECT_EQ(json["scale"], 2);
  EXPECT_EQ(json["width"], 1025);
  EXPECT_EQ(json["height"], 512);
  EXPECT_EQ(json["x1"], 2049);
  EXPECT_EQ(json["y1"], 1024);
  EXPECT_FALSE(json["layers"].contains("error")) << "without a reference";
}

class Report : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(testing::TempDir()) / ("penumbra_report_" + std::to_string(getpid()));
    fs::remove_all(folder_);
    fs::create_directory(folder_);
    run_ = sample_run();
    run_.summary.spec.reference = folder_ / "reference.exr";
    for (const MixRecord& mix : run_.mixes)
      ASSERT_TRUE(write_exr(folder_ / mix.image, gradient(32, 16), {}).ok());
    ASSERT_TRUE(write_exr(folder_ / "reference.exr", gradient(32, 16), {}).ok());
  }
  void TearDown() override { fs::remove_all(folder_); }
  void write_run() {
    ASSERT_TRUE(write_file_atomically(folder_ / "run.json", json_text(run_json(run_))).ok());
  }
  fs::path folder_;
  RunRecord run_;
};

TEST_F(Report, IsOnePageWithoutOtherFiles) {
  write_run();
  const absl::Status status = write_report(folder_);
  ASSERT_TRUE(status.ok()) << message_of(status);
  const std::string page = content(folder_ / "report.html");
  EXPECT_THAT(page, HasSubstr("bsdf:1+line-sa@v:3/balance"));
  EXPECT_THAT(page, Not(HasSubstr("{{")));
  // Nothing is loaded from anywhere: no src, no link, no @import, no fetch of an address.
  EXPECT_FALSE(
      std::regex_search(page, std::regex("<script[^>]+src=|<link|<img[^>]+src=\"http|@import|url\\(http")));
}

TEST_F(Report, TheDataCannotEndItsScriptElement) {
  run_.summary.spec.scene = "/x/</script><script>alert(1)</script>.pbrt";
  write_run();
  ASSERT_TRUE(write_report(folder_).ok());
  EXPECT_THAT(content(folder_ / "report.html"), Not(HasSubstr("alert(1)</script>")));
}

TEST_F(Report, MissingImagesAreSaidOnThePage) {
  write_run();
  fs::remove(folder_ / run_.mixes[0].image);
  fs::remove(folder_ / "reference.exr");
  const auto data = report_data(folder_);
  ASSERT_TRUE(data.ok()) << message_of(data.status());
  EXPECT_TRUE((*data)["images"][0].is_null());
  EXPECT_FALSE((*data)["images"][1].is_null());
  EXPECT_TRUE((*data)["reference"].is_null());
  EXPECT_EQ((*data)["notes"].size(), 2u);
}

TEST_F(Report, LargeImagesBringTheirErrorAndTheReferenceHasNone) {
  for (const MixRecord& mix : run_.mixes)
    ASSERT_TRUE(write_exr(folder_ / mix.image, gradient(1100, 960), {}).ok());
  ASSERT_TRUE(write_exr(folder_ / "reference.exr", gradient(1100, 960), {}).ok());
  write_run();
  auto data = report_data(folder_);
  ASSERT_TRUE(data.ok()) << message_of(data.status());
  for (const Json& image : (*data)["images"]) EXPECT_TRUE(image["layers"].contains("error"));
  EXPECT_FALSE((*data)["reference"]["layers"].contains("error"));
  fs::remove(folder_ / "reference.exr");
  data = report_data(folder_);
  ASSERT_TRUE(data.ok());
  for (const Json& image : (*data)["images"]) EXPECT_FALSE(image["layers"].contains("error"));
}

TEST_F(Report, NeedsARun) {
  EXPECT_EQ(write_report(folder_).code(), absl::StatusCode::kNotFound);
  std::ofstream(folder_ / "run.json") << "{\"schema\": 2}";
  EXPECT_THAT(message_of(write_report(folder_)), HasSubstr("not a run.json of schema 1"));
}

}  // namespace
}  // namespace penumbra
