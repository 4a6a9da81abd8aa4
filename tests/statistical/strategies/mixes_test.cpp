// Mixes of every combination against plain ones: the same picture.
#include <gtest/gtest.h>

#include "tests/statistical/render/agreement.h"

namespace penumbra {
namespace {

using test::expect_agreement;

const std::string kHead = R"(LookAt 0 3 6  0 0.6 0  0 1 0
Camera "perspective" "float fov" 40
Film "image" "integer xresolution" 64 "integer yresolution" 48
WorldBegin
Material "matte" "rgb Kd" [ 0.5 0.6 0.7 ]
Shape "trianglemesh" "integer indices" [ 0 1 2 0 2 3 ] "point P" [ -4 0 -4  -4 0 4  4 0 4  4 0 -4 ]
Material "plastic" "rgb Kd" [ 0.4 0.2 0.2 ] "rgb Ks" [ 0.4 0.4 0.4 ] "float roughness" 0.05
Shape "trianglemesh" "integer indices" [ 0 1 2  0 2 3  0 1 4 ] "point P" [ -0.8 0.5 -0.4  0.7 0.6 -0.5  0.8 0.8 0.5  -0.6 0.7 0.4  0 1.3 0 ]
Material "translucent" "rgb Kd" [ 0.4 0.4 0.4 ] "rgb Ks" [ 0 0 0 ] "rgb reflect" [ 0.5 0.5 0.5 ] "rgb transmit" [ 0.5 0.5 0.5 ]
Shape "trianglemesh" "integer indices" [ 0 1 2 ] "point P" [ -2 0.2 0.3  -1 0.2 0.3  -1.4 2.6 -0.2 ]
)";
std::string area_light(const std::string& shape) {
  return "AttributeBegin\nAreaLightSource \"diffuse\" \"rgb L\" [ 8 7 6 ]\nMaterial \"matte\" \"rgb Kd\" [ 0 "
         "0 0 ]\n" +
         shape + "\nAttributeEnd\n";
}
const std::string kQuad =
    area_light(R"(Shape "quad" "point o" [ -0.7 2.2 -0.5 ] "vector u" [ 1.4 0 0 ] "vector v" [ 0 0 0.9 ])");
const std::string kTriangle = area_light(
    R"(Shape "trianglemesh" "integer indices" [ 0 1 2 ] "point P" [ 0.4 1.9 -0.5  1.9 1.7 -0.4  1 1.6 0.8 ])");

TEST(Mixes, SmoothedOnes) {
  expect_agreement(
      test::load_text(kHead + kQuad),
      {"sa:4", "bsdf:1+line-sa@u:1/smooth=0.2", "bsdf:2+line-sa@v:1/smooth=auto",
       "sa:1+line-area@30:1/smooth-ease=0.5", "bsdf:1+sa:1+line-sa@u:1+line-sa@v:1/smooth-ease=auto",
       "area:1+line-area@90:1/smooth=0.05"},
      {.passes = 48});
}

TEST(Mixes, AnalyticAndUniformLines) {
  expect_agreement(
      test::load_text(kHead + kQuad + kTriangle),
      {"sa:4", "line-analytic@0:2", "line-analytic@70:1", "line-analytic@0:1+line-analytic@90:1/average",
       "line-analytic@20:1+sa:1/average", "bsdf:1+line-analytic@0:1", "line-uniform@0:2", "line-uniform@25:2",
       "bsdf:1+line-uniform@60:1"},
      {.passes = 48});
}

TEST(Mixes, SolidAngleLinesOnATriangle) {
  expect_agreement(test::load_text(kHead + kTriangle),
                   {"sa:4", "line-sa@u:2", "line-sa@v:2", "line-sa@u:1+line-sa@v:1", "bsdf:1+line-sa@u:1",
                    "bsdf:1+line-sa@v:1/free", "bsdf:1+line-sa@u:1/smooth=auto"},
                   {.passes = 64});
}

/// `n` small triangles on a vault over the floor, facing anywhere, some of them bright.
std::string many_triangles(int n) {
  std::string points, indices;
  uint64_t state = 1;
  const auto random = [&state] {
    state = state * 6364136223846793005u + 1442695040888963407u;
    return double(state >> 11) * 0x1p-53;
  };
  for (int i = 0; i < n; ++i) {
    const double x = 6 * random() - 3, z = 6 * random() - 3, y = 2.2 + 0.5 * random();
    for (int c = 0; c < 3; ++c) {
      points += std::to_string(x + 0.08 * random()) + " " + std::to_string(y + 0.04 * random()) + " " +
                std::to_string(z + 0.08 * random()) + " ";
      indices += std::to_string(3 * i + c) + " ";
    }
  }
  return "Shape \"trianglemesh\" \"integer indices\" [ " + indices + "] \"point P\" [ " + points + "]";
}

TEST(Mixes, TenThousandTrianglesAndFarLights) {
  expect_agreement(test::load_text(kHead + area_light(many_triangles(10000)) + R"(
LightSource "infinite" "rgb L" [ 0.2 0.2 0.3 ]
LightSource "distant" "rgb L" [ 0.5 0.5 0.4 ] "point from" [ 1 3 1 ] "point to" [ 0 0 0 ]
LightSource "point" "rgb I" [ 1 1 1 ] "point from" [ 1 1 1 ]
)"),
                   {"bsdf:16", "sa:1", "bsdf:2+sa:1", "line-area@0:1", "bsdf:1+line-sa@u:1/smooth=auto"},
                   {.passes = 24});
}

}  // namespace
}  // namespace penumbra
