#include "worker/textures/textures.h"

#include <OpenImageIO/imageio.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "proto/status.h"
#include "tests/unit/textures/temporary_scene.h"
#include "worker/textures/noise.h"

namespace penumbra {
namespace {

using testing::HasSubstr;

SurfacePoint point_at(float u, float v, const Vec3f& p = Vec3f(0)) {
  SurfacePoint point;
  point.p = p;
  point.uv = {u, v};
  point.dpdx = point.dpdy = Vec3f(0);
  return point;
}

class TexturesTest : public testing::Test {
 protected:
  /// Builds all textures of a text; the last is looked at.
  absl::StatusOr<Textures> build(const std::string& text, bool strict = false) {
    const SceneDescription description = scene_.parse(text);
    last_ = static_cast<int>(description.textures.size()) - 1;
    return Textures::build(description, scene_.files(), std::vector<bool>(description.textures.size(), true),
                           strict, warnings_);
  }
  Rgb color(const std::string& text, const SurfacePoint& point) {
    const auto textures = build(text);
    EXPECT_TRUE(textures.ok()) << textures.status();
    return textures.ok() ? textures->evaluate(RgbValue{Rgb(0), last_}, point) : Rgb(-1);
  }

  TemporaryScene scene_;
  std::vector<std::string> warnings_;
  int last_ = -1;
};

TEST_F(TexturesTest, ConstantsNeedNoTexture) {
  EXPECT_EQ(Textures().evaluate(FloatValue{0.25f}, point_at(0, 0)), 0.25f);
  EXPECT_EQ(Textures().evaluate(RgbValue{Rgb(1, 2, 3)}, point_at(0, 0)), Rgb(1, 2, 3));
}

TEST_F(TexturesTest, ConstantScaleMix) {
  const std::string two = R"(Texture "a" "spectrum" "constant" "rgb value" [1 2 3]
    Texture "b" "spectrum" "constant" "rgb value" [2 4 10] )";
  EXPECT_EQ(
      color(two + R"(Texture "c" "spectrum" "scale" "texture tex1" "a" "texture tex2" "b")", point_at(0, 0)),
      Rgb(2, 8, 30));
  EXPECT_EQ(
      color(two + R"(Texture "c" "spectrum" "scale" "texture tex" "a" "float scale" 3)", point_at(0, 0)),
      Rgb(3, 6, 9));
  EXPECT_EQ(
      color(two + R"(Texture "c" "spectrum" "mix" "texture tex1" "a" "texture tex2" "b" "float amount" 0.25)",
            point_at(0, 0)),
      Rgb(1.25f, 2.5f, 4.75f));
}

TEST_F(TexturesTest, FloatTexturesAreGrey) {
  const auto textures = build(R"(Texture "a" "float" "constant" "float value" 0.75)");
  ASSERT_TRUE(textures.ok());
  EXPECT_EQ(textures->evaluate(FloatValue{0, last_}, point_at(0, 0)), 0.75f);
  EXPECT_EQ(textures->evaluate(FloatValue{0, last_}, Vec2f(0), Vec3f(0)), 0.75f);
}

TEST_F(TexturesTest, Bilerp) {
  const std::string text = R"(Texture "a" "spectrum" "bilerp" "rgb v00" [1 0 0] "rgb v10" [0 1 0]
    "rgb v01" [0 0 1] "rgb v11" [1 1 1])";
  EXPECT_EQ(color(text, point_at(1, 0)), Rgb(0, 1, 0));
  EXPECT_EQ(color(text, point_at(0, 1)), Rgb(0, 0, 1));
  EXPECT_EQ(color(text, point_at(0.5f, 0.5f)), Rgb(0.5f, 0.5f, 0.5f));
}

TEST_F(TexturesTest, UvWithItsMapping) {
  EXPECT_EQ(
      color(R"(Texture "a" "spectrum" "uv" "float uscale" 2 "float vdelta" 0.25)", point_at(0.75f, 0.5f)),
      Rgb(0.5f, 0.75f, 0));
}

TEST_F(TexturesTest, CheckerboardAndItsFilter) {
  const std::string text = R"(Texture "a" "spectrum" "checkerboard" "float uscale" 4 "float vscale" 4
    "rgb tex1" [1 1 1] "rgb tex2" [0 0 0])";
  EXPECT_EQ(color(text, point_at(0.1f, 0.1f)), Rgb(1));
  EXPECT_EQ(color(text, point_at(0.3f, 0.1f)), Rgb(0));
  EXPECT_EQ(color(text, point_at(0.3f, 0.3f)), Rgb(1));
  EXPECT_EQ(color(text, point_at(-0.1f, 0.1f)), Rgb(0));
  SurfacePoint border = point_at(0.25f + 0.0125f, 0.1f);  // of a box of ±0.1 squares, three quarters are odd
  border.dudx = 0.025f;
  EXPECT_NEAR(color(text, border).x, 0.25f, 1e-5f);
  border.dudx = 3;
  EXPECT_NEAR(color(text, border).x, 0.5f, 1e-5f);
}

TEST_F(TexturesTest, SolidCheckerboardScalesWithItsTransformAsInPbrt3) {
  const std::string text = R"(Scale 2 2 2 Texture "a" "spectrum" "checkerboard" "integer dimension" 3
    "rgb tex1" [1 1 1] "rgb tex2" [0 0 0])";
  EXPECT_EQ(color(text, point_at(0, 0, {0.2f, 0.2f, 0.2f})), Rgb(1));
  EXPECT_EQ(color(text, point_at(0, 0, {0.7f, 0.2f, 0.2f})), Rgb(0));
}

TEST_F(TexturesTest, SphericalMappingFollowsTheTexturesTransform) {
  const std::string text = R"(Translate 5 0 0 Texture "a" "spectrum" "uv" "string mapping" "spherical")";
  const Rgb east = color(text, point_at(0, 0, {6, 1e-6f, 0}));
  EXPECT_NEAR(east.x, 0.5f, 1e-5f);
  EXPECT_NEAR(east.y, 0, 1e-5f);
  EXPECT_NEAR(color(text, point_at(0, 0, {5, 1, 0})).y, 0.25f, 1e-5f);
}

TEST_F(TexturesTest, PlanarMapping) {
  EXPECT_EQ(color(R"(Texture "a" "spectrum" "uv" "string mapping" "planar" "vector v1" [0 0 0.5]
    "vector v2" [0.25 0 0])",
                  point_at(0, 0, {1, 7, 1})),
            Rgb(0.5f, 0.25f, 0));
}

void write_png(const std::string& path) {
  auto out = OIIO::ImageOutput::create(path);
  ASSERT_TRUE(out);
  ASSERT_TRUE(out->open(path, OIIO::ImageSpec(2, 2, 3, OIIO::TypeDesc::UINT8)));
  const uint8_t texels[] = {255, 0, 0, 0, 255, 0, 0, 0, 255, 255, 255, 255};  // red green / blue white
  ASSERT_TRUE(out->write_image(OIIO::TypeDesc::UINT8, texels));
  out->close();
}

TEST_F(TexturesTest, ImagemapOrientationScaleInvert) {
  write_png(scene_.path("a.png"));
  const std::string image = R"(Texture "a" "spectrum" "imagemap" "string filename" "a.png" )";
  EXPECT_EQ(color(image, point_at(0.25f, 0.25f)), Rgb(0, 0, 1));
  EXPECT_EQ(color(image, point_at(0.25f, 0.75f)), Rgb(1, 0, 0));
  EXPECT_EQ(color(image + "\"float scale\" 3", point_at(0.75f, 0.75f)), Rgb(0, 3, 0));
  EXPECT_EQ(color(image + "\"bool invert\" true", point_at(0.75f, 0.75f)), Rgb(1, 0, 1));
  EXPECT_EQ(color(image + "\"string wrap\" \"black\"", point_at(3, 3)), Rgb(0));
}

TEST_F(TexturesTest, AMissingImageIsAWarningAndOne) {
  const std::string text = R"(Texture "a" "spectrum" "imagemap" "string filename" "gone.png")";
  EXPECT_EQ(color(text, point_at(0.5f, 0.5f)), Rgb(1));
  ASSERT_EQ(warnings_.size(), 1u);
  EXPECT_THAT(warnings_[0], testing::AllOf(HasSubstr("scene.pbrt:2:1"), HasSubstr("gone.png")));
  EXPECT_EQ(build(text, true).status().code(), absl::StatusCode::kInvalidArgument);
}

TEST_F(TexturesTest, UnusedTexturesAreNotLoaded) {
  const SceneDescription description =
      scene_.parse(R"(Texture "a" "spectrum" "imagemap" "string filename" "gone.png"
    Texture "b" "spectrum" "constant" "rgb value" [1 1 1])");
  ASSERT_TRUE(Textures::build(description, scene_.files(), {false, true}, true, warnings_).ok());
  EXPECT_THAT(warnings_, testing::IsEmpty());
}

TEST_F(TexturesTest, TexturesOfUsedTexturesAreLoadedToo) {
  const SceneDescription description = scene_.parse(R"(Texture "a" "spectrum" "constant" "rgb value" [2 2 2]
    Texture "b" "spectrum" "scale" "texture tex1" "a")");
  const auto textures = Textures::build(description, scene_.files(), {false, true}, true, warnings_);
  ASSERT_TRUE(textures.ok()) << textures.status();
  EXPECT_EQ(textures->evaluate(RgbValue{Rgb(0), 1}, point_at(0, 0)), Rgb(2));
}

TEST_F(TexturesTest, FaultsNameTheirPlace) {
  write_png(scene_.path("a.png"));
  const std::string image = "Texture \"a\" \"spectrum\" \"imagemap\" \"string filename\" \"a.png\"\n";
  EXPECT_THAT(message_of(build(image + "\"string wrap\" \"spiral\"").status()), HasSubstr("scene.pbrt:3:"));
  EXPECT_THAT(message_of(build(image + "\"string encoding\" \"jazz\"").status()), HasSubstr("jazz"));
  EXPECT_THAT(message_of(build(image + "\"string mapping\" \"inside-out\"").status()),
              HasSubstr("inside-out"));
  EXPECT_THAT(message_of(build(image + "\"float maxanisotropy\" 0").status()), HasSubstr("maxanisotropy"));
}

TEST_F(TexturesTest, ATextureThatCostsTwoToTheManyIsRefused) {
  std::string text = "Texture \"t0\" \"float\" \"constant\"\n";
  for (int i = 1; i <= 40; ++i) {
    const std::string before = "\"t" + std::to_string(i - 1) + "\"";
    text += "Texture \"t" + std::to_string(i) + "\" \"float\" \"scale\" \"texture tex1\" " + before +
            " \"texture tex2\" " + before + "\n";
  }
  EXPECT_THAT(message_of(build(text).status()), HasSubstr("lookups"));
}

TEST(Noise, IsSmoothBoundedAndZeroOnTheLattice) {
  float least = 0, most = 0;
  for (int i = 0; i < 20000; ++i) {
    const Vec3f p(0.037f * i, 0.011f * i, -0.023f * i);
    const float value = noise(p);
    least = std::min(least, value);
    most = std::max(most, value);
    EXPECT_NEAR(noise(p + Vec3f(1e-3f)), value, 0.02f);
  }
  EXPECT_LT(least, -0.5f);
  EXPECT_GT(most, 0.5f);
  EXPECT_GE(least, -1.1f);
  EXPECT_LE(most, 1.1f);
  EXPECT_EQ(noise({3, -4, 5}), 0);
  EXPECT_EQ(noise(Vec3f(1e30f)), 0);
}

TEST(Noise, AWideFootprintLeavesNoDetail) {
  EXPECT_EQ(fbm({0.3f, 0.4f, 0.5f}, Vec3f(100), Vec3f(0), {8, 0.5f}), 0);
  EXPECT_NE(fbm({0.3f, 0.4f, 0.5f}, Vec3f(0), Vec3f(0), {8, 0.5f}), 0);
}

}  // namespace
}  // namespace penumbra
