#include "worker/materials/bump.h"

#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/textures/temporary_scene.h"
#include "worker/materials/material.h"

namespace penumbra {
namespace {

SurfacePoint flat_point() {
  SurfacePoint point;
  point.p = Vec3f(0);
  point.uv = {0.4f, 0.6f};
  point.ng = point.ns = Vec3f(0, 0, 1);
  point.dpdu = Vec3f(2, 0, 0);
  point.dpdv = Vec3f(0, 4, 0);
  point.dndu = point.dndv = point.dpdx = point.dpdy = Vec3f(0);
  point.wo = Vec3f(0, 0, 1);
  return point;
}

class Bump : public testing::Test {
 protected:
  /// The shading normal that the scene's last material gives at the point.
  Vec3f normal(const std::string& text, const SurfacePoint& point) {
    const SceneDescription description = scene_.parse(text + "\nShape \"sphere\"\n");
    std::vector<std::string> warnings;
    auto materials = Materials::build(description, scene_.files(), true, warnings);
    EXPECT_TRUE(materials.ok()) << materials.status();
    auto textures = Textures::build(description, scene_.files(), materials->used_textures(), true, warnings);
    EXPECT_TRUE(textures.ok()) << textures.status();
    const int last = static_cast<int>(description.materials.size()) - 1;
    EXPECT_TRUE(materials->has_bump(last));
    return materials->shade(last, point, *textures).ns();
  }
  TemporaryScene scene_;
};

// Height 0.6 u over a square of 2 × 4: slope 0.3 along x.
constexpr const char* kRamp = R"(Texture "h" "float" "bilerp" "float v00" 0 "float v01" 0 "float v10" 0.6
  "float v11" 0.6
  Material "matte" "texture bumpmap" "h")";

TEST_F(Bump, ARampTiltsTheNormalAgainstItsSlope) {
  const Vec3f expected = Vec3f(-0.3f, 0, 1).normalized();
  EXPECT_NEAR((normal(kRamp, flat_point()) - expected).length(), 0, 1e-4);
  SurfacePoint with_footprint = flat_point();
  with_footprint.dudx = with_footprint.dvdy = 0.01f;
  EXPECT_NEAR((normal(kRamp, with_footprint) - expected).length(), 0, 1e-5);
}

TEST_F(Bump, TheSecondAxisToo) {
  const char* text =
      R"(Texture "h" "float" "bilerp" "float v00" 0 "float v01" 0.8 "float v10" 0 "float v11" 0.8
    Material "matte" "texture displacement" "h")";
  EXPECT_NEAR((normal(text, flat_point()) - Vec3f(0, -0.2f, 1).normalized()).length(), 0, 1e-4);
}

TEST_F(Bump, TheNormalStaysOnTheGeometricSide) {
  SurfacePoint mirrored = flat_point();
  mirrored.dpdu = -mirrored.dpdu;  // a parametrisation of the other handedness
  const Vec3f n = normal(kRamp, mirrored);
  EXPECT_GT(n.z, 0);
  EXPECT_NEAR((n - Vec3f(0.3f, 0, 1).normalized()).length(), 0, 1e-4);
}

TEST_F(Bump, ACurvedSurfaceMovesOutwardsByTheHeight) {
  // Constant height on a surface that bends along u: the tangent is stretched, the normal is not turned.
  SurfacePoint point = flat_point();
  point.dndu = Vec3f(0.5f, 0, 0);
  const char* text = R"(Texture "h" "float" "constant" "float value" 3
    Material "matte" "texture bumpmap" "h")";
  EXPECT_NEAR((normal(text, point) - Vec3f(0, 0, 1)).length(), 0, 1e-6);
}

TEST_F(Bump, AFrameWithoutAreaKeepsTheNormal) {
  SurfacePoint point = flat_point();
  point.dpdu = point.dpdv = Vec3f(0);
  EXPECT_EQ(normal(kRamp, point), Vec3f(0, 0, 1));
}

TEST_F(Bump, OfAMixTheFirstMaterialsCounts) {
  const std::string text = std::string(R"(Texture "h" "float" "bilerp" "float v00" 0 "float v01" 0
    "float v10" 0.6 "float v11" 0.6
    MakeNamedMaterial "a" "string type" "matte" "texture bumpmap" "h"
    MakeNamedMaterial "b" "string type" "matte"
    Material "mix" "string namedmaterial1" "a" "string namedmaterial2" "b")");
  EXPECT_NEAR((normal(text, flat_point()) - Vec3f(-0.3f, 0, 1).normalized()).length(), 0, 1e-4);
}

TEST_F(Bump, NormalMap) {
  auto out = OIIO::ImageOutput::create(scene_.path("n.exr"));
  ASSERT_TRUE(out && out->open(scene_.path("n.exr"), OIIO::ImageSpec(1, 1, 3, OIIO::TypeDesc::FLOAT)));
  const float texel[] = {0.8f, 0.5f, 0.9f};  // (0.6, 0, 0.8)
  out->write_image(OIIO::TypeDesc::FLOAT, texel);
  out->close();
  const Vec3f n = normal(R"(Material "diffuse" "string normalmap" "n.exr")", flat_point());
  EXPECT_NEAR((n - Vec3f(0.6f, 0, 0.8f)).length(), 0, 1e-3);
}

}  // namespace
}  // namespace penumbra
