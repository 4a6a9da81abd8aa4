#include "worker/render/camera.h"

#include <gtest/gtest.h>

namespace penumbra {
namespace {

SceneDescription looking_along_z(double fov) {
  SceneDescription d;
  d.files = {"camera.pbrt"};
  d.camera.type = "perspective";
  Param p;
  p.type = "float";
  p.name = "fov";
  p.numbers = {fov};
  d.camera.params.all = {p};
  return d;
}

double tangent(const Vec3f& d, int axis) { return double(d[axis]) / d.z; }

TEST(Camera, FieldOfViewSpansTheShorterAxis) {
  const auto camera = Camera::build(looking_along_z(90), 400, 200);
  ASSERT_TRUE(camera.ok());
  // 90° across the height: ±1 at the upper and lower edge, ±2 at the sides; up is +y, right is +x.
  EXPECT_NEAR(tangent(camera->ray({200, 0}).direction, 1), 1, 1e-6);
  EXPECT_NEAR(tangent(camera->ray({200, 200}).direction, 1), -1, 1e-6);
  EXPECT_NEAR(tangent(camera->ray({400, 100}).direction, 0), 2, 1e-6);
  EXPECT_NEAR(tangent(camera->ray({0, 100}).direction, 0), -2, 1e-6);
}

TEST(Camera, NeighbourRaysAreOnePixelAway) {
  const auto camera = Camera::build(looking_along_z(60), 64, 64);
  const CameraRay ray = camera->ray({10.25, 20.5});
  EXPECT_EQ(ray.direction_dx, camera->ray({11.25, 20.5}).direction);
  EXPECT_EQ(ray.direction_dy, camera->ray({10.25, 21.5}).direction);
}

TEST(Camera, MirroredPlacementMirrorsThePicture) {
  SceneDescription d = looking_along_z(90);
  d.camera_placement.start.setScale(Vec3d(-1, 1, 1));
  const auto camera = Camera::build(d, 100, 100);
  EXPECT_NEAR(tangent(camera->ray({100, 50}).direction, 0), -1, 1e-6);
}

TEST(Camera, RefusesImpossibleFieldsOfViewAndSingularPlacements) {
  for (double fov : {0.0, -10.0, 180.0, 400.0})
    EXPECT_EQ(Camera::build(looking_along_z(fov), 8, 8).status().code(), absl::StatusCode::kInvalidArgument);
  SceneDescription d = looking_along_z(60);
  d.camera_placement.start.setScale(Vec3d(1, 0, 1));
  EXPECT_EQ(Camera::build(d, 8, 8).status().code(), absl::StatusCode::kInvalidArgument);
}

}  // namespace
}  // namespace penumbra
