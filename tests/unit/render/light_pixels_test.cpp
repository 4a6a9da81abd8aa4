#include "worker/render/light_pixels.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/render.h"

namespace penumbra {
namespace {

// Looks along +z with a field of view of 90 degrees: at depth d the picture spans [-d, d].
std::string scene_with_light(const std::string& quad) {
  return "Camera \"perspective\" \"float fov\" 90\nWorldBegin\nAttributeBegin\n"
         "AreaLightSource \"diffuse\" \"rgb L\" [ 200 200 200 ] \"bool twosided\" \"true\"\n"
         "Shape \"quad\" " +
         quad + "\nAttributeEnd\n";
}

std::vector<uint8_t> marks(const std::string& quad, int edge, const PixelRect& tile) {
  const ScenePtr scene = test::load_text(scene_with_light(quad));
  const auto camera = Camera::build(scene->description, edge, edge);
  return light_pixels(*scene, *camera, tile);
}

TEST(LightPixels, AreThoseWhoseFilterMeetsTheProjection) {
  // At depth 4 a pixel of 16 is 0.5 wide; the light spans pixels [8, 10.5) to the right, [5, 8) upwards.
  const auto seen =
      marks(R"("point o" [ 0 0 4 ] "vector u" [ 1.25 0 0 ] "vector v" [ 0 1.5 0 ])", 16, {0, 0, 16, 16});
  for (int y = 0; y < 16; ++y)
    for (int x = 0; x < 16; ++x) {
      const bool inside = x >= 8 && x < 11 && y >= 5 && y < 8, near = x >= 7 && x < 12 && y >= 4 && y < 9;
      if (inside) {
        EXPECT_EQ(seen[size_t(y * 16 + x)], 1) << x << ' ' << y;
      }
      if (!near) {
        EXPECT_EQ(seen[size_t(y * 16 + x)], 0) << x << ' ' << y;
      }
    }
}

TEST(LightPixels, ATileMarksWhatThePictureMarks) {
  const std::string quad = R"("point o" [ -1 -1 3 ] "vector u" [ 2.2 0.7 0 ] "vector v" [ -0.4 1.5 1 ])";
  const auto picture = marks(quad, 24, {0, 0, 24, 24}), tile = marks(quad, 24, {5, 9, 19, 17});
  for (int y = 9; y < 17; ++y)
    for (int x = 5; x < 19; ++x) EXPECT_EQ(tile[size_t((y - 9) * 14 + x - 5)], picture[size_t(y * 24 + x)]);
}

/// From the left border to the right one while the shutter is open.
TEST(LightPixels, ALightThatMovesMarksItsWay) {
  const ScenePtr scene = test::load_text(
      "Camera \"perspective\" \"float fov\" 90\nWorldBegin\nAttributeBegin\nAreaLightSource \"diffuse\"\n"
      "ActiveTransform StartTime Translate -3.5 0 0 ActiveTransform EndTime Translate 3 0 0 ActiveTransform "
      "All\n"
      "Shape \"quad\" \"point o\" [ 0 0.1 4 ] \"vector u\" [ 0.4 0 0 ] \"vector v\" [ 0 0.3 0 "
      "]\nAttributeEnd\n");
  ASSERT_TRUE(scene);
  const auto camera = Camera::build(scene->description, 16, 16);
  const auto seen = light_pixels(*scene, *camera, {0, 0, 16, 16});
  for (int x = 1; x < 15; ++x) EXPECT_EQ(seen[size_t(7 * 16 + x)], 1) << x;
  for (int x = 0; x < 16; ++x) EXPECT_EQ(seen[size_t(12 * 16 + x)] + seen[size_t(3 * 16 + x)], 0) << x;
}

TEST(LightPixels, ALightThatReachesBehindTheCameraIsCutOff) {
  // A wall at x = 1 from behind the camera to depth 8: it fills the right half up to x = 8 + 8/8.
  const auto seen =
      marks(R"("point o" [ 1 -50 -2 ] "vector u" [ 0 100 0 ] "vector v" [ 0 0 10 ])", 16, {0, 0, 16, 16});
  for (int y = 0; y < 16; ++y) {
    EXPECT_EQ(seen[size_t(y * 16 + 15)], 1);
    EXPECT_EQ(seen[size_t(y * 16 + 7)], 0);
  }
  const auto behind =
      marks(R"("point o" [ -1 -1 -4 ] "vector u" [ 2 0 0 ] "vector v" [ 0 2 0 ])", 16, {0, 0, 16, 16});
  EXPECT_EQ(std::count(behind.begin(), behind.end(), 1), 0);
}

/// A light that covers 30 % of one pixel's width and all of its height, and nothing else in the scene.
TEST(LightPixels, EmissionHasTheSameMeanAndFarLessNoiseThanOneRayAPass) {
  const ScenePtr scene =
      test::load_text(scene_with_light(R"("point o" [ 0 0 1 ] "vector u" [ 0.3 0 0 ] "vector v" [ 0 1 0 ])"));
  ASSERT_TRUE(scene);
  JobSpec spec = test::job(2, 2, {"sa:1"}, 64);
  spec.sampler = SamplerKind::kIndependent;
  const test::Rendered rendered = test::render(*scene, spec);
  const FilmImage& image = rendered.images[0];
  const size_t pixel = image.index(1, 0) * 3;
  const double mean = image.rgb[pixel], variance = image.variance[pixel];
  EXPECT_NEAR(mean, 0.3 * 200, 4.5 * std::sqrt(variance));
  // One ray a pass: 200² · 0.3 · 0.7 / 64 = 131. Sixteen: a sixteenth of that.
  EXPECT_LT(variance, 131 / 8.0);
  EXPECT_GT(variance, 131 / 32.0);
}

TEST(TileRenderer, ACameraGridTakesItsSamplesAtTheCentresOfCells) {
  // The light's edge lies between the only two columns of a grid of two cells a pixel: 0.25 and 0.75.
  const ScenePtr scene =
      test::load_text(scene_with_light(R"("point o" [ 0 0 1 ] "vector u" [ 0.3 0 0 ] "vector v" [ 0 1 0 ])"));
  JobSpec spec = test::job(2, 2, {"sa:1"}, 256);
  spec.camera_grid = 1;
  const test::Rendered coarse = test::render(*scene, spec);
  EXPECT_EQ(coarse.images[0].rgb[coarse.images[0].index(1, 0) * 3], 0.f)
      << "the pixel's centre is not on the light";
  spec.camera_grid = 2;
  const test::Rendered rendered = test::render(*scene, spec);
  const double mean = rendered.images[0].rgb[rendered.images[0].index(1, 0) * 3];
  EXPECT_NEAR(mean, 100, 12) << "half the cells' centres are on the light, whatever it covers of them";
}

}  // namespace
}  // namespace penumbra
