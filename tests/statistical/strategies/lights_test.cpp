// Lights that are in their own way, that rays do not meet, or that have holes: every strategy must see of
// them what the others see.
#include <gtest/gtest.h>

#include "tests/statistical/render/agreement.h"

namespace penumbra {
namespace {

const std::string kHead = R"(LookAt 0 3 6  0 0.6 0  0 1 0
Camera "perspective" "float fov" 40
Film "image" "integer xresolution" 64 "integer yresolution" 48
WorldBegin
Material "matte" "rgb Kd" [ 0.5 0.6 0.7 ]
Shape "trianglemesh" "integer indices" [ 0 1 2 0 2 3 ] "point P" [ -4 0 -4  -4 0 4  4 0 4  4 0 -4 ]
)";
std::string light(const std::string& shape, const std::string& more = "") {
  return "AttributeBegin\nAreaLightSource \"diffuse\" \"rgb L\" [ 8 7 6 ] " + more +
         "\nMaterial \"matte\" \"rgb Kd\" [ 0 0 0 ]\n" + shape + "\nAttributeEnd\n";
}

std::string sphere(const std::string& more = "") {
  return "Translate -1.3 1.2 0 Shape \"sphere\" \"float radius\" 0.5 " + more;
}
/// Upright and open below: what it emits inwards lights the floor.
std::string cylinder(const std::string& more = "") {
  return "Translate 1.3 1.2 0 Rotate 75 1 0.2 0 "
         "Shape \"cylinder\" \"float radius\" 0.5 \"float zmin\" -0.3 \"float zmax\" 0.4 " +
         more;
}

test::AgreementSpec passes(int64_t n) {
  test::AgreementSpec how;
  how.passes = n;
  return how;
}

const std::vector<std::string> kPoints = {"bsdf:8", "area:3", "sa:3", "bsdf:2+area:2"};

TEST(LightsInTheirOwnWay, TwoSidedSphere) {
  test::expect_agreement(test::load_text(kHead + light(sphere(), "\"bool twosided\" true")), kPoints,
                         passes(64));
}

TEST(LightsInTheirOwnWay, TwoSidedCylinder) {
  test::expect_agreement(test::load_text(kHead + light(cylinder(), "\"bool twosided\" true")), kPoints,
                         passes(64));
}

TEST(LightsInTheirOwnWay, SphereAndCylinderThatEmitInwards) {
  test::expect_agreement(test::load_text(kHead + light("ReverseOrientation\n" + sphere()) +
                                         light("ReverseOrientation\n" + cylinder())),
                         kPoints, passes(64));
}

}  // namespace
}  // namespace penumbra
