#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "proto/status.h"
#include "tests/unit/textures/temporary_scene.h"
#include "worker/textures/cie.h"
#include "worker/textures/named_spectra.h"
#include "worker/textures/textures.h"

namespace penumbra {
namespace {

using testing::HasSubstr;

class Spectrum : public testing::Test {
 protected:
  /// The colour that a parameter of a matte material is read as.
  absl::StatusOr<Rgb> color(const std::string& param) {
    description_ = scene_.parse("Material \"matte\" " + param + "\nShape \"sphere\"\n");
    if (description_.materials.empty()) return absl::InternalError("not parsed");
    return to_rgb(description_.materials[0].params.all.at(0), description_, scene_.files());
  }
  void expect_near(const absl::StatusOr<Rgb>& value, const Rgb& expected, float tolerance) {
    ASSERT_TRUE(value.ok()) << value.status();
    for (int i = 0; i < 3; ++i) EXPECT_NEAR((*value)[i], expected[i], tolerance) << "channel " << i;
  }

  TemporaryScene scene_;
  SceneDescription description_;
};

TEST_F(Spectrum, RgbIsItself) {
  expect_near(color("\"rgb Kd\" [0.1 0.2 0.3]"), {0.1f, 0.2f, 0.3f}, 1e-7f);
}

TEST_F(Spectrum, XyzOfTheRedPrimary) {
  expect_near(color("\"xyz Kd\" [0.412453 0.212671 0.019334]"), {1, 0, 0}, 1e-4f);
}

// As in pbrt-v3, a constant spectrum is illuminant E, which is not RGB's white.
TEST_F(Spectrum, ConstantSpectrumHasLuminanceOne) {
  const auto value = color("\"spectrum Kd\" [400 1 700 1]");
  expect_near(value, {1.205f, 0.948f, 0.909f}, 0.01f);
  EXPECT_NEAR(luminance(*value), 1, 1e-3f);
}

TEST_F(Spectrum, SamplesAreSortedAndInterpolated) {
  const auto sorted = color("\"spectrum Kd\" [400 0 550 1 700 0]");
  const auto shuffled = color("\"spectrum Kd\" [700 0 400 0 550 1]");
  ASSERT_TRUE(sorted.ok() && shuffled.ok());
  EXPECT_EQ(*sorted, *shuffled);
  EXPECT_GT(sorted->y, sorted->x);
  EXPECT_GT(sorted->y, sorted->z);
}

TEST_F(Spectrum, BlackbodyOfDaylightIsNearlyWhiteAndOfIncandescenceRed) {
  const auto day = color("\"blackbody Kd\" [6500 1]"), lamp = color("\"blackbody Kd\" [2700 2]");
  ASSERT_TRUE(day.ok() && lamp.ok());
  EXPECT_NEAR(day->x / day->z, 1, 0.12);
  EXPECT_GT(lamp->x, 2 * lamp->y);
  EXPECT_GT(lamp->y, 3 * lamp->z);
  // One number: v4, luminance 1.
  const auto v4 = color("\"blackbody Kd\" [2700]");
  EXPECT_NEAR(luminance(*v4), 1, 1e-4);
  EXPECT_NEAR(v4->x / v4->z, lamp->x / lamp->z, 1e-2 * lamp->x / lamp->z);
}

TEST_F(Spectrum, FilesHaveComments) {
  scene_.write("white.spd", "# a comment\n400 1\n700 1 # the end\n");
  expect_near(color("\"spectrum Kd\" \"white.spd\""), *color("\"spectrum Kd\" [400 1 700 1]"), 1e-6f);
}

TEST_F(Spectrum, FaultsNameTheirPlace) {
  scene_.write("bad.spd", "400 1\n700 green\n");
  EXPECT_THAT(message_of(color("\"spectrum Kd\" \"bad.spd\"").status()),
              testing::AllOf(HasSubstr("scene.pbrt:2:"), HasSubstr("bad.spd:2"), HasSubstr("green")));
  EXPECT_THAT(message_of(color("\"spectrum Kd\" \"none.spd\"").status()), HasSubstr("none.spd"));
  scene_.write("odd.spd", "400 1 700\n");
  EXPECT_THAT(message_of(color("\"spectrum Kd\" \"odd.spd\"").status()), HasSubstr("pairs"));
  EXPECT_THAT(message_of(color("\"blackbody Kd\" [-5]").status()), HasSubstr("kelvin"));
}

TEST_F(Spectrum, NamedMetals) {
  expect_near(color("\"spectrum Kd\" \"metal-Cu-eta\""), copper().eta, 0);
  expect_near(color("\"spectrum Kd\" \"metal-Cu-k\""), copper().k, 0);
  EXPECT_FALSE(named_spectrum("metal-Xx-eta"));
  EXPECT_FALSE(named_spectrum("metal-Cu"));
}

TEST(NamedSpectra, GlassesHaveTheirCatalogueIndexAtTheDLine) {
  const std::pair<const char*, double> glasses[] = {
      {"glass-BK7", 1.5168},  {"glass-BAF10", 1.6700}, {"glass-FK51A", 1.48656}, {"glass-LASF9", 1.85025},
      {"glass-SF5", 1.67271}, {"glass-SF10", 1.72828}, {"glass-SF11", 1.78472},  {"glass-F5", 1.6034}};
  for (const auto& [name, index] : glasses) {
    ASSERT_TRUE(glass_index(name, 587.56)) << name;
    EXPECT_NEAR(*glass_index(name, 587.56), index, 2e-4) << name;
  }
}

TEST(NamedSpectra, IlluminantD65IsWhite) {
  const auto white = named_spectrum("stdillum-D65");
  ASSERT_TRUE(white);
  for (int i = 0; i < 3; ++i) EXPECT_NEAR((*white)[i], 1, 2e-3);
}

TEST(Cie, MatchingFunctionsIntegrateToEqualEnergyWhite) {
  Vec3d sum(0);
  for (double nm = kLeastWavelength; nm <= kMostWavelength; ++nm) sum += color_matching(nm);
  EXPECT_NEAR(sum.y, 106.857, 0.6);  // pbrt's CIE_Y_integral
  EXPECT_NEAR(sum.x / sum.y, 1, 5e-3);
  EXPECT_NEAR(sum.z / sum.y, 1, 5e-3);
}

}  // namespace
}  // namespace penumbra
