// Every strategy against every other on scenes of our own: they estimate the same picture by different
// roads, so their block means must agree (z-tests, Šidák over all pairs and blocks).
#include <gtest/gtest.h>

#include "tests/statistical/render/agreement.h"

namespace penumbra {
namespace {

void expect_agreement(const ScenePtr& scene, const std::vector<std::string>& mixes, int64_t passes,
                      SamplerKind sampler = SamplerKind::kIndependent, int64_t group = 1) {
  test::AgreementSpec how;
  how.passes = passes;
  how.group = group;
  how.sampler = sampler;
  test::expect_agreement(scene, mixes, how);
}

const std::string kHead = R"(LookAt 0 3 6  0 0.6 0  0 1 0
Camera "perspective" "float fov" 40
Film "image" "integer xresolution" 64 "integer yresolution" 48
WorldBegin
Material "matte" "rgb Kd" [ 0.5 0.6 0.7 ]
Shape "trianglemesh" "integer indices" [ 0 1 2 0 2 3 ] "point P" [ -4 0 -4  -4 0 4  4 0 4  4 0 -4 ]
)";
const std::string kBlocker = R"(Material "plastic" "rgb Kd" [ 0.4 0.2 0.2 ] "rgb Ks" [ 0.4 0.4 0.4 ] "float roughness" 0.05
Shape "trianglemesh" "integer indices" [ 0 1 2  0 2 3  0 1 4 ] "point P" [ -0.8 0.5 -0.4  0.7 0.6 -0.5  0.8 0.8 0.5  -0.6 0.7 0.4  0 1.3 0 ]
)";
std::string area_light(const std::string& shape, const std::string& more = "") {
  return "AttributeBegin\nAreaLightSource \"diffuse\" \"rgb L\" [ 8 7 6 ] " + more + "\nMaterial \"matte\" \"rgb Kd\" [ 0 0 0 ]\n" +
         shape + "\nAttributeEnd\n";
}
const std::string kQuad = R"(Shape "quad" "point o" [ -0.7 2.2 -0.5 ] "vector u" [ 1.4 0 0 ] "vector v" [ 0 0 0.9 ])";

TEST(Agreement, RectangleLight) {
  expect_agreement(test::load_text(kHead + kBlocker + area_light(kQuad)),
                   {"bsdf:8", "area:2", "sa:2", "line-area@0:2", "line-area@90:1", "line-area@33:2", "line-sa@u:2",
                    "line-sa@v:1", "bsdf:1+sa:1", "bsdf:1+line-sa@u:2", "line-sa@u:1+line-sa@v:1",
                    "area:1+line-area@90:1", "line-area@0:1+line-area@90:1/average", "bsdf:1+line-sa@v:2/free",
                    "sa:1+line-area@45:1/free", "bsdf:1+sa:2/power", "bsdf:1+line-sa@u:1/power",
                    "visible-area:2", "bsdf:1+visible-area:2", "sa:1+visible-area:1/free", "area:1+visible-area:1/average",
                    "visible-area:1+line-sa@v:1", "visible-area:2+line-sa@u:1/smooth=auto"},
                   64);
}

/// Whatever a plan chooses: here each tile has another candidate of `auto`.
TEST(Agreement, AutoWithADifferentCandidateInEveryTile) {
  test::AgreementSpec how;
  how.passes = 64;
  how.tile = 16;
  test::expect_agreement(test::load_text(kHead + kBlocker + area_light(kQuad)), {"auto", "sa:4", "bsdf:2+line-sa@u:2"},
                         how);
}

TEST(Agreement, StratifiedAndSobolSamplers) {
  for (SamplerKind sampler : {SamplerKind::kStratified, SamplerKind::kSobol})
    expect_agreement(test::load_text(kHead + kBlocker + area_light(kQuad)),
                     {"sa:4", "line-sa@u:4", "bsdf:2+line-sa@v:2", "line-area@60:3", "visible-area:4"}, 64, sampler, 8);
}

TEST(Agreement, ObliqueQuadTriangleAndTwoSided) {
  expect_agreement(
      test::load_text(kHead + kBlocker +
                      area_light(R"(Shape "quad" "point o" [ -2 1.2 -1 ] "vector u" [ 0.9 0.2 0 ] "vector v" [ 0.3 0 0.8 ])",
                                 "\"bool twosided\" true") +
                      area_light(R"(Shape "trianglemesh" "integer indices" [ 0 1 2 ] "point P" [ 0.5 1.9 -0.5  1.9 1.7 -0.4  1 1.6 0.8 ])",
                                 "\"bool twosided\" true")),
      {"bsdf:8", "area:2", "sa:2", "line-area@0:2", "line-area@70:2", "line-sa@v:1", "bsdf:1+line-area@20:2",
       "visible-area:2", "bsdf:1+visible-area:1"}, 64);
}

TEST(Agreement, CurvedLights) {
  expect_agreement(
      test::load_text(kHead + kBlocker +
                      area_light(R"(Translate -1.5 1.6 0 Shape "sphere" "float radius" 0.4)") +
                      area_light(R"(Translate 1.5 1.9 0 Rotate 100 1 0 0 Shape "disk" "float radius" 0.5)") +
                      area_light(R"(Translate 0 1.4 -1.5 Shape "cylinder" "float radius" 0.2 "float zmin" -0.5 "float zmax" 0.5)")),
      {"bsdf:8", "area:3", "sa:3", "line-sa@u:2", "bsdf:2+sa:2", "bsdf:2+visible-area:2"}, 96);
}

TEST(Agreement, EnvironmentAndDeltaLights) {
  expect_agreement(test::load_text(kHead + kBlocker + R"(LightSource "infinite" "rgb L" [ 0.3 0.4 0.6 ]
LightSource "point" "rgb I" [ 3 3 3 ] "point from" [ 1 2 1 ]
LightSource "distant" "rgb L" [ 0.5 0.5 0.4 ] "point from" [ 1 3 1 ] "point to" [ 0 0 0 ]
)"),
                   {"bsdf:4", "sa:4", "bsdf:2+sa:2", "line-sa@u:2"}, 96);
}

TEST(Agreement, TranslucentReceiverBetweenLights) {
  expect_agreement(
      test::load_text(kHead + R"(Material "translucent" "rgb Kd" [ 0.4 0.4 0.4 ] "rgb Ks" [ 0 0 0 ] "rgb reflect" [ 0.5 0.5 0.5 ] "rgb transmit" [ 0.5 0.5 0.5 ]
Shape "trianglemesh" "integer indices" [ 0 1 2 0 2 3 ] "point P" [ -1.5 0.2 0  1.5 0.2 0  1.5 1.9 -0.3  -1.5 1.9 -0.3 ]
)" + area_light(R"(Shape "quad" "point o" [ -0.5 2.4 -1.8 ] "vector u" [ 1 0 0 ] "vector v" [ 0 0 3.2 ])")),
      {"bsdf:8", "sa:4", "line-sa@u:2", "line-sa@v:2", "line-area@90:2", "bsdf:1+line-sa@v:2",
       "visible-area:2", "bsdf:1+visible-area:2"}, 96);
}

TEST(Agreement, ManyLightsAreDrawn) {
  std::string text = kHead + kBlocker;
  for (int i = 0; i < 24; ++i)
    text += area_light("Translate " + std::to_string(-2.2 + 0.8 * (i % 6)) + " 0 " + std::to_string(-1.6 + 0.9 * (i / 6)) +
                       R"( Shape "quad" "point o" [ 0 2 0 ] "vector u" [ 0.3 0 0 ] "vector v" [ 0 0 0.25 ])");
  expect_agreement(test::load_text(text), {"bsdf:8", "sa:1", "bsdf:2+sa:1", "bsdf:1+line-sa@u:1", "line-sa@v:1",
                                           "visible-area:1", "bsdf:2+visible-area:1"}, 32);
}

TEST(Agreement, InstancesAndAlpha) {
  expect_agreement(
      test::load_text(kHead + R"(Texture "holes" "float" "checkerboard" "float uscale" 6 "float vscale" 6 "float tex1" 0 "float tex2" 1
ObjectBegin "slat"
Shape "trianglemesh" "integer indices" [ 0 1 2 0 2 3 ] "point P" [ -1 0 -0.06  1 0 -0.06  1 0.03 0.06  -1 0.03 0.06 ]
ObjectEnd
)" + [] {
        std::string s;
        for (int i = 0; i < 9; ++i)
          s += "AttributeBegin Translate 0 0.9 " + std::to_string(-1 + 0.25 * i) + " Rotate " + std::to_string(7 * i) +
               " 0 1 0 ObjectInstance \"slat\" AttributeEnd\n";
        return s;
      }() + R"(Shape "trianglemesh" "integer indices" [ 0 1 2 0 2 3 ] "point P" [ -1.5 1.2 -1  0.2 1.2 -1  0.2 1.2 1  -1.5 1.2 1 ] "float uv" [ 0 0 1 0 1 1 0 1 ] "texture alpha" "holes"
)" + area_light(kQuad)),
      {"bsdf:8", "sa:2", "line-area@0:2", "line-sa@u:2", "line-sa@v:2", "bsdf:1+line-sa@u:2", "area:1+line-sa@v:1",
       "visible-area:2", "bsdf:1+visible-area:2", "sa:1+visible-area:1"}, 64);
}

}  // namespace
}  // namespace penumbra
