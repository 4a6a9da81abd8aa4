// Points against lines, and every strategy against every other, where there is fog about.
#include <gtest/gtest.h>

#include "tests/statistical/render/agreement.h"

namespace penumbra {
namespace {

const std::vector<std::string> kMixes = {"area:2",
                                         "sa:2",
                                         "line-area@0:1",
                                         "line-area@90:1",
                                         "line-sa@u:1",
                                         "line-sa@v:1",
                                         "bsdf:1+sa:1",
                                         "bsdf:1+line-sa@v:1",
                                         "area:1+line-sa@u:1/free",
                                         "visible-area:1",
                                         "sa:2/medium=line",
                                         "bsdf:1+line-sa@v:1/medium=line"};

TEST(MediaAgreement, ShaftsThroughSlats) {
  test::AgreementSpec how;
  how.width = 48;
  how.height = 30;
  how.passes = 24;
  test::expect_agreement(test::load(PENUMBRA_SOURCE_DIR "/scenes/gallery/fog.pbrt"), kMixes, how);
}

/// The camera stands in fog; before it a ball of denser fog with a hole of vacuum, a glass ball, and a grid,
/// all touching the floor or each other.
TEST(MediaAgreement, BoundariesThatTouchAndGapsOfVacuum) {
  const std::string text =
      R"(MakeNamedMedium "thin" "string type" "homogeneous" "rgb sigma_a" [0.01 0.02 0.03] "rgb sigma_s" [0.1 0.1 0.1] "float g" 0.5
MakeNamedMedium "thick" "string type" "homogeneous" "rgb sigma_a" [0 0 0] "rgb sigma_s" [2 3 4] "float g" -0.2
MediumInterface "" "thin"
LookAt 0 1 -4  0 0.7 0  0 1 0
Camera "perspective" "float fov" 45
WorldBegin
MakeNamedMedium "smoke" "string type" "uniformgrid" "integer nx" 2 "integer ny" 2 "integer nz" 2 "float density" [0 1 2 3 4 0 6 7]
  "rgb sigma_a" [0.2 0.2 0.2] "rgb sigma_s" [0.6 0.5 0.4] "point p0" [-2 0 -1] "point p1" [-0.9 1.5 0.5]
MediumInterface "" "thin"
AttributeBegin AreaLightSource "diffuse" "rgb L" [9 8 7] Material "matte" "rgb Kd" [0 0 0]
Shape "quad" "point o" [-0.6 3 -0.5] "vector u" [1.2 0 0] "vector v" [0 0 1] AttributeEnd
Material "matte" "rgb Kd" [0.5 0.5 0.5]
Shape "trianglemesh" "integer indices" [0 1 2 0 2 3] "point P" [-6 0 -6  -6 0 6  6 0 6  6 0 -6]
Shape "trianglemesh" "integer indices" [0 1 2 0 2 3] "point P" [-0.9 1.8 -1  0 1.8 -1  0 1.8 0.6  -0.9 1.8 0.6]
AttributeBegin MediumInterface "smoke" "thin" Material "interface" Shape "trianglemesh"
"integer indices" [0 2 1 0 3 2 4 5 6 4 6 7 0 1 5 0 5 4 1 2 6 1 6 5 2 3 7 2 7 6 3 0 4 3 4 7]
"point P" [-2 0 -1 -0.9 0 -1 -0.9 1.5 -1 -2 1.5 -1 -2 0 0.5 -0.9 0 0.5 -0.9 1.5 0.5 -2 1.5 0.5] AttributeEnd
AttributeBegin Translate 0 0.7 0
  AttributeBegin MediumInterface "thick" "thin" Material "none" Shape "sphere" "float radius" 0.7 AttributeEnd
  AttributeBegin MediumInterface "" "thick" Material "none" Shape "sphere" "float radius" 0.35 AttributeEnd
AttributeEnd
AttributeBegin Translate 1.2 0.5 0 MediumInterface "" "thin" Material "glass" Shape "sphere" "float radius" 0.5 AttributeEnd
)";
  test::AgreementSpec how;
  how.width = 40;
  how.height = 30;
  how.passes = 24;
  test::expect_agreement(test::load_text(text), kMixes, how);
}

/// Black fog about a camera that looks along a beam of light; only what the fog scatters is seen.
std::string beam(const std::string& world) {
  return R"(MakeNamedMedium "m" "string type" "homogeneous" "rgb sigma_a" [0.05 0.05 0.05] "rgb sigma_s" [0.1 0.1 0.1]
MediumInterface "" "m"
LookAt 0 0 0  0 0 1  0 1 0
Camera "perspective" "float fov" 5
WorldBegin
)" + world;
}

void expect_lines_as_points(const std::string& world) {
  test::AgreementSpec how;
  how.width = 12;
  how.height = 12;
  how.passes = 64;
  test::expect_agreement(test::load_text(beam(world)), {"sa:2", "sa:2/medium=line"}, how);
}

TEST(MediaAgreement, ManyLightsThatMissTheMiddleOfTheRay) {
  std::string world;
  for (int i = 0; i < 17; ++i) {
    const std::string z = std::to_string(2 + 0.05 * i);
    world += "LightSource \"spot\" \"point from\" [0 2 " + z + "] \"point to\" [0 0 " + z +
             "] \"float coneangle\" 10 \"float conedeltaangle\" 2 \"rgb I\" [2 2 2]\n";
  }
  expect_lines_as_points(world);
}

TEST(MediaAgreement, ALightInThePlaneOfASlantedPanel) {
  expect_lines_as_points(
      R"(AttributeBegin AreaLightSource "diffuse" "rgb L" [9 9 9] Material "matte" "rgb Kd" [0 0 0]
Shape "quad" "point o" [-1.18939454 1.66659557 8.55479713] "vector u" [0.932327346 0.296397372 0.207157714]
"vector v" [0 -0.57286746 0.819648018] AttributeEnd
Material "matte" "rgb Kd" [0 0 0]
Shape "trianglemesh" "integer indices" [0 1 2 0 2 3] "point P" [-2.58788556 2.0813007 7.01458853
1.14142383 3.26689019 7.84321939 1.14142383 0.975420345 11.1218115 -2.58788556 -0.210169143 10.2931806]
)");
}

TEST(MediaAgreement, ALightThatEmitsInwards) {
  expect_lines_as_points(
      "AttributeBegin Translate 0 0.6 3 AreaLightSource \"diffuse\" \"rgb L\" [9 9 9] \"bool twosided\" "
      "\"true\" "
      "Material \"matte\" \"rgb Kd\" [0 0 0] Shape \"sphere\" \"float radius\" 0.5 AttributeEnd\n");
}

/// A black ball is all there is to hide anything, so its size says nothing of how far a point of the fog is
/// from it.
TEST(MediaAgreement, AFogFarFromEverythingLiesInTheShadowOfABall) {
  const ScenePtr scene = test::load_text(
      R"(MakeNamedMedium "m" "string type" "homogeneous" "rgb sigma_a" [0.01 0.01 0.01] "rgb sigma_s" [0.1 0.1 0.1]
MediumInterface "" "m"
LookAt 0 0 0  0 0 1  0 1 0
Camera "perspective" "float fov" 4
WorldBegin
LightSource "distant" "rgb L" [3 3 3] "point from" [0 0 1] "point to" [0 0 0]
AttributeBegin MediumInterface "m" "" Material "interface" Shape "sphere" "float radius" 20 AttributeEnd
MediumInterface "m" "m"
Material "matte" "rgb Kd" [0 0 0]
AttributeBegin Translate 0 0 3 Shape "sphere" "float radius" 0.5 AttributeEnd
)");
  ASSERT_TRUE(scene);
  const std::vector<std::string> mixes = {"sa:2", "bsdf:2", "bsdf:1+sa:1", "sa:2/medium=line"};
  const test::Rendered rendered = test::render(*scene, test::job(8, 8, mixes, 16));
  for (size_t m = 0; m < mixes.size(); ++m)
    for (const float value : rendered.images[m].rgb) EXPECT_EQ(value, 0) << mixes[m];
}

}  // namespace
}  // namespace penumbra
