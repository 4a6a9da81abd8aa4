#include "scenes/quadrics.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include "tests/unit/scenes/scene_folder.h"

namespace penumbra {
namespace {

using testing::HasSubstr;

constexpr double kPi = std::numbers::pi;

double area_of(const TriangleMesh& mesh) {
  double area = 0;
  for (size_t i = 0; i < mesh.indices.size(); i += 3) {
    const Vec3d p0(mesh.positions[mesh.indices[i]]), p1(mesh.positions[mesh.indices[i + 1]]),
        p2(mesh.positions[mesh.indices[i + 2]]);
    area += (p1 - p0).cross(p2 - p0).length() / 2;
  }
  return area;
}

/// Every face looks the way its vertices' normals do.
void expect_winding_follows_normals(const TriangleMesh& mesh) {
  for (size_t i = 0; i < mesh.indices.size(); i += 3) {
    const Vec3f p0 = mesh.positions[mesh.indices[i]];
    const Vec3f face =
        (mesh.positions[mesh.indices[i + 1]] - p0).cross(mesh.positions[mesh.indices[i + 2]] - p0);
    for (size_t k = 0; k < 3; ++k) EXPECT_GT(face.dot(mesh.normals[mesh.indices[i + k]]), 0) << i;
  }
}

/// Half-edges that no face runs the other way along, vertices at the same place being one.
size_t open_edges(const TriangleMesh& mesh) {
  std::map<std::array<float, 3>, int> places;
  std::vector<int> place;
  for (const Vec3f& p : mesh.positions)
    place.push_back(places.try_emplace({p.x + 0.0f, p.y + 0.0f, p.z + 0.0f}, static_cast<int>(places.size()))
                        .first->second);
  std::map<std::pair<int, int>, int> balance;
  for (size_t i = 0; i < mesh.indices.size(); ++i) {
    const int a = place[mesh.indices[i]], b = place[mesh.indices[i % 3 == 2 ? i - 2 : i + 1]];
    balance[std::minmax(a, b)] += a < b ? 1 : -1;
  }
  return static_cast<size_t>(
      std::count_if(balance.begin(), balance.end(), [](auto& e) { return e.second != 0; }));
}

ShapeEntity shape(std::string_view type, std::string_view params) {
  return parsed(fmt::format("WorldBegin Shape \"{}\" {}", type, params)).shapes.at(0);
}

const SceneDescription kScene = [] {
  SceneDescription scene;
  scene.files = {"a.pbrt"};
  return scene;
}();

TEST(SphereMesh, IsClosedOutwardAndWithinItsBound) {
  const TriangleMesh mesh = unit_sphere();
  EXPECT_EQ(mesh.triangles(), 2u * kTurnSteps * (kPoleSteps - 1));
  EXPECT_EQ(open_edges(mesh), 0u);
  expect_winding_follows_normals(mesh);
  for (size_t i = 0; i < mesh.positions.size(); ++i) {
    EXPECT_NEAR(mesh.positions[i].length(), 1, 2e-7f);
    EXPECT_LT((mesh.positions[i] - mesh.normals[i]).length(), 2e-7f);
  }
  // The deepest point of any face: its centre of gravity is close to it.
  const double bound = 2 * (1 - std::cos(kPi / kTurnSteps));
  for (size_t i = 0; i < mesh.indices.size(); i += 3) {
    const Vec3f centre = (mesh.positions[mesh.indices[i]] + mesh.positions[mesh.indices[i + 1]] +
                          mesh.positions[mesh.indices[i + 2]]) /
                         3.0f;
    EXPECT_GT(centre.length(), 1 - bound);
  }
  EXPECT_NEAR(area_of(mesh), 4 * kPi, 4 * kPi * 3e-4);
}

TEST(SphereMesh, HasPbrtsParametrisation) {
  const TriangleMesh mesh = mesh_of(Sphere{2, -2, 2, 2 * kPi});
  for (size_t i = 0; i < mesh.positions.size(); i += 37) {
    const Vec3f& p = mesh.positions[i];
    EXPECT_NEAR(p.z, -2 * std::cos(kPi * mesh.uvs[i].y), 1e-6);
    const double ring = 2 * std::sin(kPi * mesh.uvs[i].y);
    EXPECT_NEAR(p.x, ring * std::cos(2 * kPi * mesh.uvs[i].x), 1e-6);
    EXPECT_NEAR(p.y, ring * std::sin(2 * kPi * mesh.uvs[i].x), 1e-6);
  }
}

TEST(SphereMesh, PartialSweepsHaveTheZonesArea) {
  const auto sphere = sphere_of(
      shape("sphere", "\"float radius\" 2 \"float zmin\" 1.5 \"float zmax\" -1 \"float phimax\" 90"), kScene);
  ASSERT_TRUE(sphere.ok());
  EXPECT_EQ(sphere->z_min, -1);
  EXPECT_EQ(sphere->z_max, 1.5);
  EXPECT_FALSE(sphere->full());
  const TriangleMesh mesh = mesh_of(*sphere);
  const double area = 2 * 2.5 * kPi / 2;  // r h φ
  EXPECT_NEAR(area_of(mesh), area, area * 3e-4);
  expect_winding_follows_normals(mesh);
  for (const Vec3f& p : mesh.positions) {
    EXPECT_GE(p.x, -1e-6f);
    EXPECT_GE(p.y, 0);
    EXPECT_GE(p.z, -1 - 1e-6f);
    EXPECT_LE(p.z, 1.5f + 1e-6f);
  }
}

TEST(DiskMesh, LooksUpAndHasItsExactArea) {
  const auto disk = disk_of(shape("disk", "\"float height\" 3 \"float radius\" 2"), kScene);
  ASSERT_TRUE(disk.ok());
  EXPECT_TRUE(disk->full());
  const TriangleMesh mesh = mesh_of(*disk);
  EXPECT_NEAR(area_of(mesh), 4 * kPi, 4 * kPi * 1e-6);
  expect_winding_follows_normals(mesh);
  EXPECT_EQ(mesh.normals.at(0), Vec3f(0, 0, 1));
  EXPECT_EQ(mesh.positions.at(0).z, 3);
  EXPECT_EQ(mesh.uvs.at(0), Vec2f(0, 0));  // v = 0 at the rim
  const auto ring = disk_of(shape("disk", "\"float innerradius\" 0.5 \"float phimax\" 180"), kScene);
  ASSERT_TRUE(ring.ok());
  EXPECT_NEAR(area_of(mesh_of(*ring)), kPi / 2 * 0.75, 1e-3);
}

TEST(CylinderMesh, LooksOutAndHasPbrtsParametrisation) {
  const auto cylinder =
      cylinder_of(shape("cylinder", "\"float radius\" 2 \"float zmin\" -3 \"float zmax\" 1"), kScene);
  ASSERT_TRUE(cylinder.ok());
  const TriangleMesh mesh = mesh_of(*cylinder);
  expect_winding_follows_normals(mesh);
  EXPECT_EQ(open_edges(mesh), 2u * kTurnSteps);
  EXPECT_NEAR(area_of(mesh), 2 * kPi * 2 * 4, 16 * kPi * 1e-4);
  for (size_t i = 0; i < mesh.positions.size(); ++i)
    EXPECT_NEAR(mesh.positions[i].z, -3 + 4 * mesh.uvs[i].y, 1e-6);
}

TEST(Quadrics, WithoutSurfaceAreErrors) {
  const auto fault = [](std::string_view type, std::string_view params) {
    const ShapeEntity entity = shape(type, params);
    if (type == "sphere") return message_of(sphere_of(entity, kScene).status());
    if (type == "disk") return message_of(disk_of(entity, kScene).status());
    return message_of(cylinder_of(entity, kScene).status());
  };
  EXPECT_THAT(fault("sphere", "\"float radius\" 0"), HasSubstr("radius 0"));
  EXPECT_THAT(fault("disk", "\"float radius\" -1"), HasSubstr("radius -1"));
  EXPECT_THAT(fault("sphere", "\"float zmin\" 2 \"float zmax\" 3"), HasSubstr("leave nothing"));
  EXPECT_THAT(fault("cylinder", "\"float zmin\" 1"), HasSubstr("leave nothing"));
  EXPECT_THAT(fault("sphere", "\"float phimax\" 0"), HasSubstr("phimax"));
  EXPECT_THAT(fault("disk", "\"float innerradius\" 1"), HasSubstr("inner radius"));
  EXPECT_EQ(fault("sphere", "\"float phimax\" 400 \"float zmin\" -9"), "");
}

}  // namespace
}  // namespace penumbra
