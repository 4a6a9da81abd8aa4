// A scene far from the origin gives the picture it gives at the origin.
#include "worker/render/render_space.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "scenes/parser.h"
#include "tests/support/render.h"
#include "tests/unit/textures/temporary_scene.h"

namespace penumbra {
namespace {

std::string point(const Vec3d& p) {
  return fmt::format(" {} {} {} ", p.x, p.y, p.z);
}

/// Everything that has a place in the world: shapes with and without a transform, an instance, lights, solid
/// and mapped textures. `baked`: the offset stands in the coordinates instead of in a transform.
std::string scene_text(const Vec3d& at, bool baked = false) {
  const Vec3d in_file = baked ? at : Vec3d(0);
  std::string text = "LookAt" + point(at + Vec3d(0, 3, 6)) + point(at + Vec3d(0, 0.5, 0)) + "0 1 0\n";
  text += "Camera \"perspective\" \"float fov\" 40\nWorldBegin\n";
  text +=
      "ObjectBegin \"o\" Shape \"trianglemesh\" \"integer indices\" [ 0 1 2 ] \"point P\" [ -1 1 0  1 1 0  0 "
      "1 1 ] "
      "ObjectEnd\n";
  if (!baked) text += "Translate" + point(at) + "\n";
  const auto corner = [&](double x, double y, double z) { return point(in_file + Vec3d(x, y, z)); };
  const auto floor_at = [&](double x0, double x1) {
    return "Shape \"trianglemesh\" \"integer indices\" [ 0 1 2 0 2 3 ] \"point P\" [" + corner(x0, 0, -4) +
           corner(x0, 0, 4) + corner(x1, 0, 4) + corner(x1, 0, -4) + "]\n";
  };
  text +=
      R"(Texture "solid" "spectrum" "checkerboard" "integer dimension" 3 "rgb tex1" [ 0.2 0.2 0.2 ] "rgb tex2" [ 0.8 0.8 0.8 ]
Texture "plane" "spectrum" "checkerboard" "string mapping" "planar" "vector v1" [ 0.75 0 0 ] "vector v2" [ 0 0 0.5 ] "rgb tex1" [ 0.1 0.1 0.1 ] "rgb tex2" [ 0.7 0.7 0.7 ]
Texture "ball" "spectrum" "uv" "string mapping" "spherical"
)";
  text += "Material \"matte\" \"texture Kd\" \"solid\"\n" + floor_at(-4, -1);
  text += "Material \"matte\" \"texture Kd\" \"plane\"\n" + floor_at(-1, 1);
  text += "Material \"matte\" \"texture Kd\" \"ball\"\n" + floor_at(1, 4);
  text += "AttributeBegin Translate" + point(in_file) + " ObjectInstance \"o\" AttributeEnd\n";
  text += "LightSource \"point\" \"rgb I\" [ 5 5 5 ] \"point from\" [" + corner(1, 3, 1) + "]\n";
  text += "AreaLightSource \"diffuse\" \"rgb L\" [ 8 8 8 ]\nShape \"quad\" \"point o\" [" +
          corner(-0.5, 2.5, -0.5) + "] \"vector u\" [ 1 0 0 ] \"vector v\" [ 0 0 1 ]\n";
  return text;
}

/// Without textures that stand in the world: they have the world's precision, wherever the scene is rendered.
std::string untextured(std::string text) {
  for (size_t at; (at = text.find("\"texture Kd\"")) != std::string::npos;)
    text.replace(at, text.find('\n', at) - at, "\"rgb Kd\" [ 0.5 0.6 0.7 ]");
  return text;
}

FilmImage picture(const std::string& text) {
  const ScenePtr scene = test::load_text(text);
  JobSpec job = test::job(32, 24, {"sa:1+line-sa@u:1"}, 16);
  return test::render(*scene, job).images[0];
}

/// The same random numbers: pixels differ only where an edge falls on the other side of a sample.
void expect_same_picture(const std::string& a, const std::string& b, double tolerance) {
  const FilmImage first = picture(a), second = picture(b);
  double sum = 0, total = 0;
  for (size_t i = 0; i < first.rgb.size(); ++i) {
    sum += std::abs(first.rgb[i] - second.rgb[i]);
    total += first.rgb[i];
  }
  EXPECT_GT(total, 0);
  EXPECT_LT(sum, tolerance * total);
}

TEST(RenderSpace, AMovedSceneGivesTheSamePicture) {
  const std::string here = untextured(scene_text({0, 0, 0}));
  expect_same_picture(here, untextured(scene_text({0x1p21, -0x1p20, 0x1p22})), 1e-3);
  expect_same_picture(here, untextured(scene_text({1e9, 1e9, -1e9})), 1e-3);
}

TEST(RenderSpace, TexturesOfTheWorldMoveWithIt) {
  // Whole periods of the patterns: solid textures see twice the move (pbrt-v3 maps by the transform, not by
  // its inverse), planar ones 0.75 and 0.5 of it. Edges of the checks are as sharp as single precision there.
  expect_same_picture(scene_text({0, 0, 0}), scene_text({0x1p14, -0x1p13, 0x1p14}), 1e-2);
}

TEST(RenderSpace, CoordinatesThatAreFarAwayThemselves) {
  expect_same_picture(untextured(scene_text({0, 0, 0}, true)),
                      untextured(scene_text({0x1p20, -0x1p20, 0x1p20}, true)), 1e-3);
}

std::optional<Vec3d> origin_of(const std::string& text) {
  const TemporaryScene folder;
  folder.write("scene.pbrt", text);
  const auto description = parse_scene("scene.pbrt", folder.files());
  EXPECT_TRUE(description.ok()) << description.status();
  const auto origin = distant_origin(*description, folder.files());
  EXPECT_TRUE(origin.ok()) << origin.status();
  return *origin;
}

TEST(RenderSpace, OnlyDistantScenesAreMoved) {
  EXPECT_EQ(origin_of(scene_text({0, 0, 0})), std::nullopt);
  EXPECT_EQ(origin_of(scene_text({30, 20, 10})), std::nullopt);
  // Near the camera, and on a grid so coarse that what single precision tells apart there stays exact.
  const auto origin = origin_of(scene_text({1e9, 0, 0}));
  ASSERT_TRUE(origin);
  EXPECT_LT((*origin - Vec3d(1e9, 3, 6)).length(), 1e3);
  EXPECT_EQ(std::fmod(origin->x, 512), 0);
  // One thing at the origin: the scene is as large as its distance.
  EXPECT_EQ(origin_of(scene_text({1e9, 0, 0}) + "Identity Shape \"sphere\"\n"), std::nullopt);
}

}  // namespace
}  // namespace penumbra
