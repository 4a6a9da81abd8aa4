#include "client/scene_defaults.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scenes.h"

namespace penumbra {
namespace {

using testing::HasSubstr;

SceneDefaults defaults_of(const std::string& header) {
  const auto defaults = scene_defaults(parsed(header + "\nWorldBegin\nWorldEnd\n"));
  EXPECT_TRUE(defaults.ok()) << message_of(defaults.status());
  return defaults.ok() ? *defaults : SceneDefaults();
}

TEST(SceneDefaults, ComeFromFilmSamplerIntegrator) {
  const auto d = defaults_of(
      "Film \"image\" \"integer xresolution\" [64] \"integer yresolution\" [32]\n"
      "Sampler \"halton\" \"integer pixelsamples\" [9]\nIntegrator \"directlighting\" \"integer maxdepth\" "
      "[3]");
  EXPECT_EQ(d.width, 64);
  EXPECT_EQ(d.height, 32);
  EXPECT_EQ(d.passes, 9);
  EXPECT_EQ(d.max_depth, 3);
  EXPECT_FALSE(d.mix.has_value());
  EXPECT_EQ(*d.crop(64, 32), (PixelRect{0, 0, 64, 32}));
}

TEST(SceneDefaults, PbrtsOwnWhereNothingIsSaid) {
  EXPECT_EQ(defaults_of("Sampler \"random\"").passes, 4);
  EXPECT_EQ(defaults_of("Sampler \"halton\"").passes, 16);
  EXPECT_EQ(defaults_of("Sampler \"stratified\"").passes, 16);
  EXPECT_EQ(defaults_of("Sampler \"stratified\" \"integer xsamples\" [2] \"integer ysamples\" [3]").passes,
            6);
  EXPECT_EQ(defaults_of("Integrator \"path\"").max_depth, 5);
}

TEST(SceneDefaults, ACropWindowIsFractions) {
  const auto d = defaults_of(
      "Film \"image\" \"integer xresolution\" [100] \"integer yresolution\" [50] \"float cropwindow\" [0.1 "
      "0.5 0.2 1]");
  EXPECT_EQ(*d.crop(100, 50), (PixelRect{10, 10, 50, 50}));
  EXPECT_EQ(*d.crop(10, 5), (PixelRect{1, 1, 5, 5}));
}

TEST(SceneDefaults, ACropThatLeavesNothingIsAFault) {
  const auto d = defaults_of("Film \"image\" \"float cropwindow\" [0.5 0.5 0 1]");
  const auto crop = d.crop(100, 100);
  ASSERT_FALSE(crop.ok());
  EXPECT_THAT(message_of(crop.status()), HasSubstr("s.pbrt:1:"));
}

TEST(SceneDefaults, DepthZeroIsSaid) {
  const auto d = defaults_of("Integrator \"path\" \"integer maxdepth\" [0]");
  EXPECT_EQ(d.max_depth, 1);
  ASSERT_EQ(d.notes.size(), 1u);
  EXPECT_THAT(d.notes[0], HasSubstr("maxdepth 0"));
}

TEST(SceneDefaults, NoSamplesAreAFault) {
  const auto d =
      scene_defaults(parsed("Sampler \"halton\" \"integer pixelsamples\" [0]\nWorldBegin\nWorldEnd\n"));
  ASSERT_FALSE(d.ok());
  EXPECT_THAT(message_of(d.status()), HasSubstr("s.pbrt:1:"));
}

}  // namespace
}  // namespace penumbra
