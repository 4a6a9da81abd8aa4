// Portals as scenes have them: what is refused, and where light comes through.
#include <gmock/gmock.h>

#include "proto/status.h"
#include "scenes/parser.h"
#include "tests/support/render.h"
#include "tests/unit/scenes/scene_folder.h"
#include "worker/render/render_space.h"
#include "worker/render/scene.h"

namespace penumbra {
namespace {

using testing::HasSubstr;

std::string sky(const std::string& portal) {
  return "WorldBegin\nLightSource \"infinite\" \"rgb L\" [ 1 2 3 ]\n  \"point3 portal\" [ " + portal + " ]\n";
}

std::string fault(const std::string& portal) {
  const SceneFolder folder;
  folder.write("a.pbrt", sky(portal));
  LoadReport report;
  const auto scene = load_scene("a.pbrt", folder.files(), {}, report);
  EXPECT_FALSE(scene.ok()) << portal;
  return scene.ok() ? "" : message_of(scene.status());
}

TEST(PortalScene, WhatIsNoRectangleIsRefused) {
  EXPECT_THAT(fault("0 0 0  1 0 0  1 1 0"),
              HasSubstr("a.pbrt:3:3: a portal needs four points, here are 9 numbers"));
  const std::string no_rectangle = "a.pbrt:3:3: the portal's four points are not the corners of a rectangle";
  EXPECT_THAT(fault("0 0 0  1 0 0  1.1 1 0  0.1 1 0"), HasSubstr(no_rectangle)) << "a parallelogram";
  EXPECT_THAT(fault("0 0 0  1 0 0  1 1 0.1  0 1 0"), HasSubstr(no_rectangle)) << "not flat";
  EXPECT_THAT(fault("0 0 0  1 1 0  1 0 0  0 1 0"), HasSubstr(no_rectangle)) << "not in order";
  EXPECT_THAT(fault("0 0 0  1 0 0  1 0 0  0 0 0"), HasSubstr(no_rectangle)) << "without area";
}

TEST(PortalScene, LightComesThroughTheRectangleFromItsOtherSide) {
  const ScenePtr scene = test::load_text("Camera \"perspective\"\n" + sky("-1 0 5  1 0 5  1 2 5  -1 2 5"));
  ASSERT_TRUE(scene);
  ASSERT_EQ(scene->lights.environments.size(), 1u);
  const Environment& light = scene->lights.environments[0];
  // (p1 − p0) × (p3 − p0) = +z: that is where light goes.
  EXPECT_EQ(light.radiance({0, 1, 7}, {0, 0, -1}), Rgb(1, 2, 3));
  EXPECT_EQ(light.radiance({0, 1, 7}, {0, 0, 1}), Rgb(0));
  EXPECT_EQ(light.radiance({3, 1, 7}, {0, 0, -1}), Rgb(0));
  EXPECT_EQ(light.radiance({0, 1, 3}, {0, 0, 1}), Rgb(0));
  EXPECT_EQ(light.radiance({0, 1, 3}, {0, 0, -1}), Rgb(0));
  EXPECT_EQ(light.irradiance({0, 1, 3}), 0);
  EXPECT_GT(light.irradiance({0, 1, 7}), 0);
}

/// Its corners are in world space: no transform of the light's takes them along, a distant origin does.
TEST(PortalScene, ItsCornersAreInTheWorld) {
  const ScenePtr scene =
      test::load_text("Camera \"perspective\"\nWorldBegin Translate 9 9 9 Rotate 30 1 2 3\n" +
                      sky("-1 0 5  1 0 5  1 2 5  -1 2 5").substr(10));
  ASSERT_TRUE(scene);
  EXPECT_EQ(scene->lights.environments[0].radiance({0, 1, 7}, {0, 0, -1}), Rgb(1, 2, 3));
  const SceneDescription moved = moved_to({1, 2, 3}, parsed(sky("-1 0 5  1 0 5  1 2 5  -1 2 5")));
  EXPECT_THAT(moved.lights[0].params.find("portal")->numbers,
              testing::ElementsAre(-2, -2, 2, 0, -2, 2, 0, 0, 2, -2, 0, 2));
}

}  // namespace
}  // namespace penumbra
