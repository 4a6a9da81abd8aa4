#include <gtest/gtest.h>

#include "tests/support/render.h"
#include "worker/render/scene.h"

namespace penumbra {
namespace {

const std::string kCamera = "Camera \"perspective\"\nWorldBegin\n";
std::string light(const std::string& shape, const std::string& more = "") {
  return "AttributeBegin\nAreaLightSource \"diffuse\" \"rgb L\" [ 1 2 3 ] " + more + "\n" + shape + "\nAttributeEnd\n";
}

Vec3d normal(const AreaEmitter& e) { return emission_normal(e.shape, Vec3d(0)); }

TEST(SceneBuilder, QuadEmitsTowardsItsCrossProduct) {
  const std::string quad = R"(Shape "quad" "point o" [ 0 0 0 ] "vector u" [ 1 0 0 ] "vector v" [ 0 1 0 ])";
  const auto z_of = [&](const std::string& before) {
    const ScenePtr scene = test::load_text(kCamera + light(before + quad));
    EXPECT_TRUE(scene && scene->lights.area.size() == 1);
    return normal(scene->lights.area[0]).z;
  };
  EXPECT_EQ(z_of(""), 1);
  EXPECT_EQ(z_of("ReverseOrientation\n"), -1);
  // Scale -1 1 1 turns u × v to -z, and the transform's handedness turns it back.
  EXPECT_EQ(z_of("Scale -1 1 1\n"), 1);
  EXPECT_EQ(z_of("Scale -1 1 1\nReverseOrientation\n"), -1);
}

TEST(SceneBuilder, ShapesBecomeTheirOwnKindOfLight) {
  const ScenePtr scene = test::load_text(
      kCamera + light("Shape \"sphere\" \"float radius\" 2") + light("Shape \"disk\" \"float radius\" 0.5") +
      light("Shape \"cylinder\"") + light("Scale 1 2 1 Shape \"sphere\"") +
      light(R"(Shape "trianglemesh" "integer indices" [ 0 1 2 0 2 3 ] "point P" [ 0 0 0 1 0 0 1 1 0 0 1 0 ])"));
  ASSERT_TRUE(scene);
  const auto& area = scene->lights.area;
  EXPECT_TRUE(std::holds_alternative<SphereShape>(area[0].shape));
  EXPECT_TRUE(std::holds_alternative<DiskShape>(area[1].shape));
  EXPECT_TRUE(std::holds_alternative<CylinderShape>(area[2].shape));
  EXPECT_TRUE(std::holds_alternative<TriangleShape>(area[3].shape)) << "an ellipsoid is a mesh of lights";
  EXPECT_EQ(scene->lights.by_mesh.back().first, area.size() - 2);
  EXPECT_TRUE(scene->lights.by_mesh.back().per_primitive);
}

TEST(SceneBuilder, TwoSidedLightsAreTwoEmittersBackToBack) {
  const ScenePtr scene = test::load_text(
      kCamera + light(R"(Shape "quad" "point o" [ 0 0 0 ] "vector u" [ 1 0 0 ] "vector v" [ 0 1 0 ])",
                      "\"bool twosided\" true"));
  ASSERT_TRUE(scene);
  ASSERT_EQ(scene->lights.area.size(), 2u);
  EXPECT_EQ(normal(scene->lights.area[0]), -normal(scene->lights.area[1]));
  const PrimitiveId hit{kNone, 0, 0};
  EXPECT_EQ(scene->lights.emitter_at(hit, {0.5, 0.5, 0}, {0, 0, -1}, 0), 0u);
  EXPECT_EQ(scene->lights.emitter_at(hit, {0.5, 0.5, 0}, {0, 0, 1}, 0), 1u);
}

TEST(SceneBuilder, BlackLightsAreSurfaces) {
  const ScenePtr scene = test::load_text(kCamera + "AreaLightSource \"diffuse\" \"rgb L\" [ 0 0 0 ]\nShape \"sphere\"\n");
  ASSERT_TRUE(scene);
  EXPECT_TRUE(scene->lights.area.empty());
  EXPECT_EQ(scene->meshes.size(), 1u);
}

TEST(SceneBuilder, InterfaceSurfacesAreNotThere) {
  const ScenePtr scene = test::load_text(kCamera + "Material \"none\"\nShape \"sphere\"\n");
  ASSERT_TRUE(scene);
  EXPECT_TRUE(scene->meshes.empty());
}

TEST(SceneBuilder, SubstitutionsNameShapeCountAndStandIn) {
  const ScenePtr scene =
      test::load_text(kCamera + light("Shape \"sphere\"") +
                      light(R"(Shape "trianglemesh" "integer indices" [ 0 1 2 0 2 3 ] "point P" [ 0 0 0 1 0 0 1 1 0 0 1 0 ])"));
  ASSERT_TRUE(scene);
  const auto said = substitutions(*scene, parse_mix("line-sa@u:1+bsdf:1").value());
  ASSERT_EQ(said.size(), 1u);
  EXPECT_EQ(said[0], "line-sa@u on 1 sphere light: sa");
  const auto visible = substitutions(*scene, parse_mix("visible-area:2").value());
  ASSERT_EQ(visible.size(), 1u);
  EXPECT_EQ(visible[0], "visible-area on 1 sphere light: sa");
  // Weights of a point cannot know a line that is integrated as a whole.
  const auto weighed = substitutions(*scene, parse_mix("line-analytic@0+bsdf").value());
  ASSERT_EQ(weighed.size(), 2u);
  EXPECT_EQ(weighed[1], "line-analytic@0 on 2 triangle lights: line-area@0");
  EXPECT_EQ(substitutions(*scene, parse_mix("line-analytic@0+line-area@0/average").value()).size(), 2u);
}

TEST(SceneBuilder, SingularInstancesAreTheScenesFault) {
  LoadReport report;
  SceneDescription d;
  d.files = {"scene.pbrt"};
  d.objects.push_back({"thing", {}, {}});
  ShapeEntity sphere;
  sphere.type = "sphere";
  d.objects[0].shapes.push_back(sphere);
  InstanceEntity instance;
  instance.object = 0;
  instance.placement.start.setScale(Vec3d(1, 0, 1));
  instance.placement.end = instance.placement.start;
  d.instances.push_back(instance);
  EXPECT_EQ(build_scene(d, FolderFiles("."), {1, false}, report).status().code(), absl::StatusCode::kInvalidArgument);
}

}  // namespace
}  // namespace penumbra
