// Transforms, scopes and names: what the directives mean.
#include <gmock/gmock.h>

#include "scenes/transforms.h"
#include "tests/unit/scenes/scene_folder.h"

namespace penumbra {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr double kTolerance = 1e-12;

void expect_near(const Vec3d& a, const Vec3d& b) {
  EXPECT_LT((a - b).length(), kTolerance) << a << " " << b;
}

/// Where the shape's transform takes a point.
Vec3d moved(std::string_view transforms, const Vec3d& p) {
  const SceneDescription scene = parsed(fmt::format("WorldBegin {} Shape \"sphere\"", transforms));
  Vec3d out;
  scene.shapes.at(0).placement.start.multVecMatrix(p, out);
  return out;
}

TEST(Transforms, TheLastDirectiveActsOnPointsFirst) {
  expect_near(moved("Translate 1 2 3 Scale 2 2 2", {1, 1, 1}), {3, 4, 5});
  expect_near(moved("Scale 2 2 2 Translate 1 2 3", {1, 1, 1}), {4, 6, 8});
}

TEST(Transforms, RotationIsRightHanded) {
  expect_near(moved("Rotate 90 0 0 2", {1, 0, 0}), {0, 1, 0});
  expect_near(moved("Rotate 90 1 0 0", {0, 1, 0}), {0, 0, 1});
}

TEST(Transforms, SixteenNumbersAreColumnMajor) {
  expect_near(moved("Transform [1 0 0 0  0 1 0 0  0 0 1 0  7 8 9 1]", {1, 1, 1}), {8, 9, 10});
  expect_near(moved("Translate 1 0 0 ConcatTransform 2 0 0 0  0 2 0 0  0 0 2 0  0 0 0 1", {1, 0, 0}),
              {3, 0, 0});
  expect_near(moved("Transform [2 0 0 0  0 2 0 0  0 0 2 0  0 0 0 2]", {1, 1, 1}), {1, 1, 1});
  expect_near(moved("Translate 5 5 5 Identity", {1, 1, 1}), {1, 1, 1});
}

TEST(Transforms, LookAtTakesTheWorldToTheCamera) {
  const auto m = look_at({3, 4, 1.5}, {0.5, 0.5, 0}, {0, 0, 1});
  ASSERT_TRUE(m);
  Vec3d eye, target, above;
  m->multVecMatrix(Vec3d(3, 4, 1.5), eye);
  m->multVecMatrix(Vec3d(0.5, 0.5, 0), target);
  m->multVecMatrix(Vec3d(3, 4, 2.5), above);
  expect_near(eye, {0, 0, 0});
  EXPECT_NEAR(target.x, 0, kTolerance);
  EXPECT_NEAR(target.y, 0, kTolerance);
  EXPECT_GT(target.z, 0);
  EXPECT_GT(above.y, 0);
  EXPECT_NEAR(above.x, 0, kTolerance);
  // Left-handed, as pbrt's camera space: looking along +z with +y up, +x is to the right.
  const auto front = look_at({0, 0, 0}, {0, 0, 1}, {0, 1, 0});
  EXPECT_EQ(*front, Matrix());
}

TEST(Transforms, MeaninglessOnesAreErrors) {
  EXPECT_THAT(error_of("LookAt 1 1 1  1 1 1  0 0 1"), HasSubstr("LookAt"));
  EXPECT_THAT(error_of("LookAt 0 0 0  0 0 2  0 0 1"), HasSubstr("LookAt"));
  EXPECT_THAT(error_of("Rotate 30 0 0 0"), HasSubstr("axis"));
  EXPECT_THAT(error_of("Scale 1 nan 1"), HasSubstr("nan"));
  EXPECT_THAT(error_of("Translate 1 2"), HasSubstr("the text ends"));
  EXPECT_THAT(error_of("Transform [1 2 3]"), HasSubstr("expected a number"));
  std::string text;
  for (int i = 0; i < 20; ++i) text += "Scale 1e38 1 1 ";
  EXPECT_THAT(error_of(text), HasSubstr("no longer finite"));
}

TEST(Transforms, SingularOnesAreErrorsWhereSomethingIsPlaced) {
  EXPECT_THAT(error_of("WorldBegin Scale 0 0 0\nShape \"sphere\""),
              testing::StartsWith("a.pbrt:2:1: this shape's transform is singular"));
  EXPECT_THAT(error_of("WorldBegin Rotate 33 1 2 3 Scale 1 1 0 Rotate 77 3 2 1 Shape \"sphere\""),
              HasSubstr("singular"));
  EXPECT_THAT(error_of("WorldBegin Scale 1 0 1 LightSource \"point\""), HasSubstr("singular"));
  EXPECT_THAT(error_of("Scale 1 0 1 Camera \"perspective\""), HasSubstr("singular"));
  EXPECT_TRUE(SceneFolder().parse("WorldBegin Scale 0 0 0 Identity Shape \"sphere\"").ok());
  EXPECT_TRUE(SceneFolder().parse("WorldBegin Scale 1e-9 1 1e9 Rotate 33 1 2 3 Shape \"sphere\"").ok());
  EXPECT_THAT(error_of("WorldBegin Transform [1 0 0 5 0 1 0 0 0 0 1 0 0 0 0 1] Shape \"sphere\""),
              HasSubstr("not affine"));
}

TEST(Transforms, ALightAtInfinityHasOnlyALinearPart) {
  const SceneDescription scene =
      parsed("WorldBegin Transform [1 0 0 5 0 1 0 0 0 0 1 0 7 0 0 1] LightSource \"infinite\"");
  EXPECT_EQ(scene.lights.at(0).placement.start, Matrix());
}

TEST(Transforms, ActiveTransformMovesTheEndAlone) {
  const SceneDescription scene = parsed(
      "TransformTimes 0 2 WorldBegin ActiveTransform EndTime Translate 1 0 0 ActiveTransform All Translate 0 "
      "1 0 "
      "Shape \"sphere\" WorldEnd");
  const Placement& placement = scene.shapes.at(0).placement;
  EXPECT_TRUE(placement.moving());
  EXPECT_EQ(placement.start[3][0], 0);
  EXPECT_EQ(placement.end[3][0], 1);
  EXPECT_EQ(placement.start[3][1], 1);
  EXPECT_EQ(scene.transform_end_time, 2);
  EXPECT_THAT(error_of("ActiveTransform Sometimes"), HasSubstr("Sometimes"));
  EXPECT_THAT(error_of("TransformTimes 1 1"), HasSubstr("not before"));
}

TEST(Transforms, CameraIsACoordinateSystemAndWorldResets) {
  const SceneDescription scene = parsed(
      "Translate 0 0 5 Camera \"perspective\" WorldBegin Shape \"sphere\" CoordSysTransform \"camera\" "
      "Shape \"sphere\" CoordSysTransform \"none\" CoordinateSystem \"here\" Identity CoordSysTransform "
      "\"here\" "
      "Shape \"sphere\" CoordSysTransform \"world\" Shape \"sphere\"");
  EXPECT_EQ(scene.camera_placement.start[3][2], 5);
  EXPECT_EQ(scene.shapes.at(0).placement.start, Matrix());
  EXPECT_EQ(scene.shapes.at(1).placement.start[3][2], -5);
  EXPECT_EQ(scene.shapes.at(2).placement.start[3][2], -5);
  EXPECT_EQ(scene.shapes.at(3).placement.start, Matrix());
  EXPECT_THAT(scene.warnings, ElementsAre(HasSubstr("no coordinate system 'none'")));
}

TEST(Scopes, AttributesSaveEverythingTransformsOnlyTransforms) {
  const SceneDescription scene = parsed(
      "WorldBegin AttributeBegin Translate 1 0 0 ReverseOrientation AreaLightSource \"diffuse\" "
      "MediumInterface \"in\" \"out\" Material \"mirror\" Shape \"sphere\" AttributeEnd Shape \"sphere\" "
      "TransformBegin Translate 1 0 0 ReverseOrientation TransformEnd Shape \"sphere\"");
  const ShapeEntity &first = scene.shapes.at(0), &second = scene.shapes.at(1), &third = scene.shapes.at(2);
  EXPECT_TRUE(first.reverse_orientation);
  EXPECT_EQ(first.area_light, 0);
  EXPECT_EQ(first.material, 0);
  EXPECT_EQ(first.inside_medium, "in");
  EXPECT_EQ(first.outside_medium, "out");
  EXPECT_FALSE(second.reverse_orientation);
  EXPECT_EQ(second.area_light, -1);
  EXPECT_EQ(second.material, -1);
  EXPECT_EQ(second.placement.start, Matrix());
  EXPECT_TRUE(third.reverse_orientation);
  EXPECT_EQ(third.placement.start, Matrix());
}

TEST(Scopes, UnmatchedEndsAreWarnings) {
  EXPECT_THAT(parsed("WorldBegin AttributeEnd TransformEnd AttributeBegin WorldEnd").warnings,
              ElementsAre(HasSubstr("AttributeEnd"), HasSubstr("TransformEnd"), HasSubstr("without an end")));
}

TEST(Scopes, ObjectEndAndAttributeEndMayInterleave) {
  const SceneDescription scene = parsed(
      "WorldBegin ObjectBegin \"o\" AttributeBegin Translate 1 0 0 Shape \"sphere\" ObjectEnd AttributeEnd "
      "ObjectInstance \"o\"");
  EXPECT_EQ(scene.objects.at(0).shapes.size(), 1u);
  EXPECT_EQ(scene.instances.at(0).placement.start, Matrix());
}

TEST(Scopes, DeepNestingIsFineAndBounded) {
  const auto nested = [](int depth) {
    std::string text = "WorldBegin ";
    for (int i = 0; i < depth; ++i) text += "AttributeBegin ";
    text += "Shape \"sphere\" ";
    for (int i = 0; i < depth; ++i) text += "AttributeEnd ";
    return text;
  };
  EXPECT_THAT(parsed(nested(10'000)).warnings, IsEmpty());
  EXPECT_THAT(error_of(nested(100'001)), HasSubstr("nested more than"));
}

TEST(Names, MaterialsAreFoundBeforeAndAfterTheirDefinition) {
  const SceneDescription scene = parsed(
      "WorldBegin NamedMaterial \" Late one\" Shape \"sphere\" NamedMaterial \"never\" Shape \"sphere\" "
      "MakeNamedMaterial \" Late one\" \"rgb Kd\" [1 1 1] \"string type\" \"matte\"");
  EXPECT_EQ(scene.shapes.at(0).material, 0);
  EXPECT_EQ(scene.shapes.at(1).material, -1);
  EXPECT_THAT(scene.warnings, ElementsAre(HasSubstr("no material 'never'")));
  EXPECT_EQ(scene.materials.at(0).type, "matte");
  EXPECT_THAT(error_of("WorldBegin MakeNamedMaterial \"x\""), HasSubstr("string type"));
}

TEST(Names, ARedefinitionHoldsUntilItsScopeEnds) {
  const SceneDescription scene = parsed(
      "WorldBegin MakeNamedMaterial \"m\" \"string type\" \"matte\" AttributeBegin "
      "MakeNamedMaterial \"m\" \"string type\" \"mirror\" NamedMaterial \"m\" Shape \"sphere\" AttributeEnd "
      "NamedMaterial \"m\" Shape \"sphere\"");
  EXPECT_EQ(scene.materials.at(scene.shapes.at(0).material).type, "mirror");
  EXPECT_EQ(scene.materials.at(scene.shapes.at(1).material).type, "matte");
}

TEST(Names, TheEmptyMaterialIsNone) {
  EXPECT_EQ(parsed("WorldBegin Material \"\"").materials.at(0).type, "none");
}

TEST(Names, FloatAndSpectrumTexturesAreApart) {
  const SceneDescription scene = parsed(
      "WorldBegin Texture \"t\" \"float\" \"constant\" Texture \"t\" \"color\" \"constant\" "
      "Material \"matte\" \"texture Kd\" \"t\" \"texture sigma\" \"t\" \"texture bumpmap\" \"t\" "
      "Material \"glass\" \"texture eta\" \"t\" Material \"metal\" \"texture eta\" \"t\" "
      "Texture \"s\" \"float\" \"scale\" \"texture tex1\" \"t\"");
  EXPECT_TRUE(scene.textures.at(0).is_float);
  EXPECT_EQ(scene.materials.at(0).params.find("Kd")->texture, 1);
  EXPECT_EQ(scene.materials.at(0).params.find("sigma")->texture, 0);
  EXPECT_EQ(scene.materials.at(0).params.find("bumpmap")->texture, 0);
  EXPECT_EQ(scene.materials.at(1).params.find("eta")->texture, 0);
  EXPECT_EQ(scene.materials.at(2).params.find("eta")->texture, 1);
  EXPECT_EQ(scene.textures.at(2).params.find("tex1")->texture, 0);
}

TEST(Names, TexturesAreScopedAndMissingOnesAreSaid) {
  const SceneDescription scene = parsed(
      "WorldBegin Texture \"Map #0\" \"spectrum\" \"constant\" AttributeBegin Texture \"Map #0\" "
      "\"spectrum\" "
      "\"scale\" \"texture tex1\" \"Map #0\" Material \"matte\" \"texture Kd\" \"Map #0\" AttributeEnd "
      "Material \"matte\" \"texture Kd\" \"Map #0\" Material \"matte\" \"texture Kd\" \"none\"");
  EXPECT_EQ(scene.textures.at(1).params.find("tex1")->texture, 0);
  EXPECT_EQ(scene.materials.at(0).params.find("Kd")->texture, 1);
  EXPECT_EQ(scene.materials.at(1).params.find("Kd")->texture, 0);
  EXPECT_EQ(scene.materials.at(2).params.find("Kd")->texture, -1);
  EXPECT_THAT(scene.warnings, ElementsAre(HasSubstr("no such texture 'none'")));
}

TEST(Objects, AreInstancedBeforeAndAfterTheirDefinition) {
  const SceneDescription scene = parsed(
      "WorldBegin ObjectInstance \"o\" ObjectBegin \"o\" Shape \"sphere\" ObjectEnd Translate 1 0 0 "
      "ObjectInstance \"o\" ObjectInstance \"none\"");
  ASSERT_EQ(scene.instances.size(), 2u);
  EXPECT_EQ(scene.instances[0].object, 0);
  EXPECT_EQ(scene.instances[1].placement.start[3][0], 1);
  EXPECT_THAT(scene.warnings, ElementsAre(HasSubstr("no object 'none'")));
  EXPECT_THAT(error_of("WorldBegin ObjectBegin \"a\" ObjectBegin \"b\""), HasSubstr("inside the object"));
  EXPECT_THAT(error_of("WorldBegin ObjectEnd"), HasSubstr("without its ObjectBegin"));
  EXPECT_THAT(error_of("WorldBegin ObjectBegin \"a\" ObjectInstance \"a\""), HasSubstr("inside the object"));
}

TEST(Objects, DoNotEmit) {
  const SceneDescription scene =
      parsed("WorldBegin AreaLightSource \"diffuse\" ObjectBegin \"o\" Shape \"sphere\" ObjectEnd");
  EXPECT_EQ(scene.objects.at(0).shapes.at(0).area_light, -1);
  EXPECT_THAT(scene.warnings, ElementsAre(HasSubstr("does not emit")));
}

TEST(Media, OneNameMeansBothSides) {
  const SceneDescription scene = parsed(
      "MediumInterface \"\" \"vol\" Camera \"perspective\" WorldBegin MediumInterface \"fog\" Shape "
      "\"sphere\"");
  EXPECT_EQ(scene.camera_medium, "vol");
  EXPECT_EQ(scene.shapes.at(0).inside_medium, "fog");
  EXPECT_EQ(scene.shapes.at(0).outside_medium, "fog");
}

}  // namespace
}  // namespace penumbra
