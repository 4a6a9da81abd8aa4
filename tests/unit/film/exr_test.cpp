#include "film/exr.h"

#include <ImfChannelList.h>
#include <ImfFloatAttribute.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfIntAttribute.h>
#include <ImfOutputFile.h>
#include <ImfStringAttribute.h>
#include <ImfTiledOutputFile.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <half.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "proto/status.h"

namespace penumbra {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class Exr : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(testing::TempDir()) /
              (std::string("penumbra_exr_") + testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(folder_);
    fs::create_directory(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  std::string path(const char* name) const { return folder_ / name; }
  fs::path folder_;
};

FilmImage sample_image() {
  FilmImage image;
  image.width = 9;
  image.height = 7;
  image.window = {2, 3, 6, 5};
  for (size_t i = 0; i < 3 * image.pixels(); ++i) {
    image.rgb.push_back(static_cast<float>(i) / 7);  // not a half
    image.variance.push_back(static_cast<float>(i) / 1000);
  }
  for (size_t i = 0; i < image.pixels(); ++i) {
    image.samples.push_back(static_cast<float>(16 + i));
    image.cost.push_back(static_cast<float>(i) / 3);
  }
  return image;
}

TEST_F(Exr, RoundTripsEveryLayerAndTheWindow) {
  const FilmImage image = sample_image();
  ASSERT_TRUE(write_exr(path("a.exr"), image, {}).ok());
  const auto back = read_exr(path("a.exr"));
  ASSERT_TRUE(back.ok()) << message_of(back.status());
  EXPECT_EQ(back->width, 9);
  EXPECT_EQ(back->height, 7);
  EXPECT_EQ(back->window, image.window);
  EXPECT_EQ(back->rgb, image.rgb);
  EXPECT_EQ(back->variance, image.variance);
  EXPECT_EQ(back->samples, image.samples);
  EXPECT_EQ(back->cost, image.cost);
}

TEST_F(Exr, HeaderAndChannelsAreTheInterfaces) {
  const uint64_t seed = 0xffffffffffffffff;
  ASSERT_TRUE(
      write_exr(path("a.exr"), sample_image(), {"bsdf:4/balance", 29.5, "/s/kitchen.pbrt", seed}).ok());
  Imf::InputFile file(path("a.exr").c_str());
  const Imf::Header& h = file.header();
  EXPECT_EQ(h.typedAttribute<Imf::StringAttribute>("penumbra:mix").value(), "bsdf:4/balance");
  EXPECT_EQ(h.typedAttribute<Imf::FloatAttribute>("penumbra:cpu_seconds").value(), 29.5f);
  EXPECT_EQ(h.typedAttribute<Imf::StringAttribute>("penumbra:scene").value(), "/s/kitchen.pbrt");
  EXPECT_EQ(h.typedAttribute<Imf::StringAttribute>("penumbra:seed").value(), "18446744073709551615");
  EXPECT_EQ(h.typedAttribute<Imf::StringAttribute>("penumbra:version").value(), PENUMBRA_VERSION);
  EXPECT_EQ(h.findTypedAttribute<Imf::IntAttribute>("penumbra:partial"), nullptr);
  std::vector<std::string> names;
  for (auto c = h.channels().begin(); c != h.channels().end(); ++c) {
    names.push_back(c.name());
    EXPECT_EQ(c.channel().type, Imf::FLOAT) << c.name();
  }
  EXPECT_THAT(names, testing::UnorderedElementsAre("R", "G", "B", "variance.R", "variance.G", "variance.B",
                                                   "samples", "cost"));
}

TEST_F(Exr, AnInterruptedRunIsMarked) {
  ExrHeader header;
  header.partial = true;
  ASSERT_TRUE(write_exr(path("a.exr"), sample_image(), header).ok());
  Imf::InputFile file(path("a.exr").c_str());
  EXPECT_EQ(file.header().typedAttribute<Imf::IntAttribute>("penumbra:partial").value(), 1);
}

/// A file as another program may write it: one constant value per channel.
void write_foreign(const std::string& path, Imf::Header header, const std::map<std::string, float>& channels,
                   Imf::PixelType type) {
  const Imath::Box2i w = header.dataWindow();
  const auto width = static_cast<size_t>(w.max.x - w.min.x + 1),
             height = static_cast<size_t>(w.max.y - w.min.y + 1);
  std::map<std::string, std::vector<float>> floats;
  std::map<std::string, std::vector<half>> halves;
  Imf::FrameBuffer buffer;
  for (const auto& [name, value] : channels) {
    header.channels().insert(name, Imf::Channel(type));
    char* base = nullptr;
    const size_t size = type == Imf::HALF ? sizeof(half) : sizeof(float);
    if (type == Imf::HALF)
      base = reinterpret_cast<char*>((halves[name] = std::vector<half>(width * height, half(value))).data());
    else
      base = reinterpret_cast<char*>((floats[name] = std::vector<float>(width * height, value)).data());
    const auto offset =
        (static_cast<std::ptrdiff_t>(w.min.y) * static_cast<std::ptrdiff_t>(width) + w.min.x) *
        static_cast<std::ptrdiff_t>(size);
    buffer.insert(name, Imf::Slice(type, base - offset, size, size * width));
  }
  if (header.hasTileDescription()) {
    Imf::TiledOutputFile file(path.c_str(), header);
    file.setFrameBuffer(buffer);
    file.writeTiles(0, file.numXTiles() - 1, 0, file.numYTiles() - 1);
  } else {
    Imf::OutputFile file(path.c_str(), header);
    file.setFrameBuffer(buffer);
    file.writePixels(static_cast<int>(height));
  }
}

TEST_F(Exr, ReadsHalfWithAlphaInEveryCompression) {
  for (const auto compression :
       {Imf::NO_COMPRESSION, Imf::RLE_COMPRESSION, Imf::ZIPS_COMPRESSION, Imf::ZIP_COMPRESSION,
        Imf::PIZ_COMPRESSION, Imf::PXR24_COMPRESSION, Imf::B44_COMPRESSION, Imf::DWAA_COMPRESSION}) {
    Imf::Header header(20, 10);
    header.compression() = compression;
    write_foreign(path("h.exr"), header, {{"R", 1}, {"G", 2}, {"B", 4}, {"A", 0.5f}}, Imf::HALF);
    const auto image = read_exr(path("h.exr"));
    ASSERT_TRUE(image.ok()) << message_of(image.status());
    EXPECT_NEAR(image->rgb[3 * 57 + 1], 2, 0.005);  // B44 and DWAA are lossy
    EXPECT_TRUE(image->variance.empty());
    EXPECT_TRUE(image->samples.empty());
  }
}

TEST_F(Exr, ReadsTilesAndWindowsAwayFromTheOrigin) {
  Imf::Header header(Imath::Box2i({-5, 10}, {14, 29}), Imath::Box2i({-2, 12}, {7, 20}));
  header.setTileDescription(Imf::TileDescription(4, 4));
  write_foreign(path("t.exr"), header, {{"R", 1}, {"G", 2}, {"B", 3}}, Imf::FLOAT);
  const auto image = read_exr(path("t.exr"));
  ASSERT_TRUE(image.ok()) << message_of(image.status());
  EXPECT_EQ(image->width, 20);
  EXPECT_EQ(image->height, 20);
  EXPECT_EQ(image->window, (PixelRect{3, 2, 13, 11}));
  EXPECT_EQ(image->rgb.back(), 3);
}

TEST_F(Exr, GreyAndStandardErrorAreUnderstood) {
  write_foreign(path("y.exr"), Imf::Header(3, 2), {{"Y", 0.25f}}, Imf::FLOAT);
  const auto grey = read_exr(path("y.exr"));
  ASSERT_TRUE(grey.ok());
  EXPECT_EQ(grey->rgb, std::vector<float>(18, 0.25f));

  write_foreign(path("s.exr"), Imf::Header(3, 2),
                {{"R", 1}, {"G", 1}, {"B", 1}, {"stderr.R", 0.5f}, {"stderr.G", 0.25f}, {"stderr.B", 2}},
                Imf::FLOAT);
  const auto noisy = read_exr(path("s.exr"));
  ASSERT_TRUE(noisy.ok());
  EXPECT_EQ(noisy->variance[0], 0.25f);
  EXPECT_EQ(noisy->variance[1], 0.0625f);
  EXPECT_EQ(noisy->variance[2], 4);
}

TEST_F(Exr, WhatIsNotAnImageIsNamed) {
  EXPECT_EQ(read_exr(path("none.exr")).status().code(), absl::StatusCode::kNotFound);
  std::ofstream(path("text.exr")) << "no image";
  const auto text = read_exr(path("text.exr"));
  EXPECT_EQ(text.status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(message_of(text.status()), HasSubstr("text.exr: not a readable EXR image"));

  write_foreign(path("depth.exr"), Imf::Header(3, 2), {{"Z", 1}}, Imf::FLOAT);
  EXPECT_THAT(message_of(read_exr(path("depth.exr")).status()), HasSubstr("no channels R G B among: Z"));
}

TEST_F(Exr, TruncatedAndOversizedFilesAreRefused) {
  ASSERT_TRUE(write_exr(path("a.exr"), sample_image(), {}).ok());
  const auto size = fs::file_size(path("a.exr"));
  for (const uintmax_t n : {size - 1, size / 2, uintmax_t{100}, uintmax_t{8}, uintmax_t{0}}) {
    fs::copy_file(path("a.exr"), path("cut.exr"), fs::copy_options::overwrite_existing);
    fs::resize_file(path("cut.exr"), n);
    EXPECT_EQ(read_exr(path("cut.exr")).status().code(), absl::StatusCode::kInvalidArgument) << n;
  }
  write_foreign(path("wide.exr"), Imf::Header(kMostImageEdge + 1, 1), {{"R", 1}, {"G", 1}, {"B", 1}},
                Imf::HALF);
  EXPECT_THAT(message_of(read_exr(path("wide.exr")).status()), HasSubstr("65537x1 pixels"));
}

TEST_F(Exr, AFolderThatIsMissingIsNamed) {
  const absl::Status status = write_exr(path("no/a.exr"), sample_image(), {});
  EXPECT_THAT(message_of(status), HasSubstr("no/a.exr: cannot create"));
}

TEST_F(Exr, ReadsAReferenceOfAnotherRenderer) {
  const char* scenes = std::getenv("PENUMBRA_SCENES_DIR");
  if (scenes == nullptr) GTEST_SKIP() << "PENUMBRA_SCENES_DIR is not set";
  const fs::path reference = fs::path(scenes).parent_path() / "references" / "cornell-box.exr";
  if (!fs::exists(reference)) GTEST_SKIP() << reference << " is not there";
  const auto image = read_exr(reference);
  ASSERT_TRUE(image.ok()) << message_of(image.status());
  EXPECT_EQ(image->width, 256);
  EXPECT_EQ(image->variance.size(), image->rgb.size());
  double mean = 0;
  for (const float v : image->rgb) mean += v / static_cast<double>(image->rgb.size());
  EXPECT_NEAR(mean, 0.354188, 1e-6);
}

std::vector<FilmImage> sample_bins() {
  std::vector<FilmImage> bins(12, sample_image());
  for (size_t b = 0; b < bins.size(); ++b) {
    bins[b].samples.clear();
    bins[b].cost.clear();
    for (float& v : bins[b].rgb) v += static_cast<float>(b);
  }
  return bins;
}

TEST_F(Exr, BinsAreFurtherPartsAndReadersOfOnePartSeeThePicture) {
  const FilmImage image = sample_image();
  const std::vector<FilmImage> bins = sample_bins();
  ExrHeader header;
  header.transient = Transient{0.5, 4, 12};
  ASSERT_TRUE(write_exr(path("a.exr"), image, header, bins).ok());
  const auto picture = read_exr(path("a.exr"));
  ASSERT_TRUE(picture.ok()) << message_of(picture.status());
  EXPECT_EQ(picture->rgb, image.rgb);
  EXPECT_EQ(picture->variance, image.variance);
  EXPECT_EQ(picture->samples, image.samples);
  EXPECT_EQ(picture->window, image.window);
  const auto back = read_exr_bins(path("a.exr"));
  ASSERT_TRUE(back.ok()) << message_of(back.status());
  EXPECT_EQ(back->transient, *header.transient);
  ASSERT_EQ(back->images.size(), bins.size());
  for (size_t b = 0; b < bins.size(); ++b) {
    EXPECT_EQ(back->images[b].rgb, bins[b].rgb) << b;
    EXPECT_EQ(back->images[b].variance, bins[b].variance) << b;
    EXPECT_TRUE(back->images[b].samples.empty());
  }
}

TEST_F(Exr, AFileWithoutBinsSaysSo) {
  ASSERT_TRUE(write_exr(path("a.exr"), sample_image(), {}).ok());
  const auto bins = read_exr_bins(path("a.exr"));
  EXPECT_TRUE(absl::IsInvalidArgument(bins.status()));
  EXPECT_THAT(message_of(bins.status()), HasSubstr("no bins"));
  EXPECT_TRUE(absl::IsNotFound(read_exr_bins(path("none.exr")).status()));
}

}  // namespace
}  // namespace penumbra
