// What stands, and where, when a scene moves.
#include "scenes/standing.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "proto/status.h"
#include "scenes/needs.h"
#include "scenes/transforms.h"
#include "tests/unit/scenes/scene_folder.h"

namespace penumbra {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

const char* const kMoves = "ActiveTransform EndTime Translate 4 0 0 ActiveTransform All ";

TEST(Standing, AtTheOpeningOfTheShutter) {
  const SceneDescription moving =
      parsed(fmt::format("Camera \"perspective\" \"float shutteropen\" 0.25 WorldBegin AttributeBegin {} "
                         "Shape \"sphere\" AttributeEnd",
                         kMoves));
  ASSERT_TRUE(anything_moves(moving));
  const SceneDescription still = standing(moving, false).value();
  EXPECT_FALSE(anything_moves(still));
  EXPECT_EQ(still.shapes[0].placement.start, translation({1, 0, 0}));
  EXPECT_TRUE(standing(moving, true)->shapes[0].placement.moving());
}

/// pbrt interpolates the camera's place in the world, not the world's in the camera.
TEST(Standing, TheCameraIsInterpolatedInTheWorld) {
  const SceneDescription moving = parsed(
      "ActiveTransform EndTime Rotate 90 0 1 0 Translate -4 0 0 ActiveTransform All Camera \"perspective\" "
      "\"float shutteropen\" 0.5 WorldBegin");
  const Matrix to_camera = standing(moving, true)->camera_placement.start;
  Vec3d eye;
  to_camera.inverse().multVecMatrix(Vec3d(0), eye);
  EXPECT_NEAR((eye - Vec3d(2, 0, 0)).length(), 0, 1e-12);
}

TEST(Standing, WhatCannotMoveIsNamed) {
  const auto warnings = [](std::string_view world) {
    return unsupported(parsed(fmt::format("WorldBegin {}{}", kMoves, world)));
  };
  EXPECT_THAT(warnings("Shape \"sphere\""), ElementsAre());
  EXPECT_THAT(warnings("AreaLightSource \"diffuse\" Shape \"sphere\""), ElementsAre());
  EXPECT_THAT(warnings("Shape \"curve\""), ElementsAre(HasSubstr("motion of a curve")));
  EXPECT_THAT(warnings("LightSource \"point\""), ElementsAre(HasSubstr("at its first transform")));
  EXPECT_THAT(warnings("ObjectBegin \"o\" Shape \"sphere\" ObjectEnd"),
              ElementsAre(HasSubstr("inside an object")));
}

TEST(Standing, AMirrorAtOneEndOnlyIsRefused) {
  const auto still =
      standing(parsed("WorldBegin ActiveTransform EndTime Scale -1 1 1 Shape \"sphere\""), true);
  ASSERT_FALSE(still.ok());
  EXPECT_THAT(message_of(still.status()), HasSubstr("a.pbrt:1:"));
}

}  // namespace
}  // namespace penumbra
