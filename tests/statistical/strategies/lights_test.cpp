// Lights that are in their own way, that rays do not meet, or that have holes: every strategy must see of
// them what the others see.
#include <gtest/gtest.h>

#include "film/statistics.h"
#include "tests/statistical/render/agreement.h"

namespace penumbra {
namespace {

const std::string kHead = R"(LookAt 0 3 6  0 0.6 0  0 1 0
Camera "perspective" "float fov" 40
Film "image" "integer xresolution" 64 "integer yresolution" 48
WorldBegin
Texture "holes" "float" "checkerboard" "float uscale" 3 "float vscale" 3 "float tex1" 0 "float tex2" 1
Material "matte" "rgb Kd" [ 0.5 0.6 0.7 ]
Shape "trianglemesh" "integer indices" [ 0 1 2 0 2 3 ] "point P" [ -4 0 -4  -4 0 4  4 0 4  4 0 -4 ]
)";
const std::string kBlocker =
    R"(Material "plastic" "rgb Kd" [ 0.4 0.2 0.2 ] "rgb Ks" [ 0.4 0.4 0.4 ] "float roughness" 0.05
Shape "trianglemesh" "integer indices" [ 0 1 2  0 2 3  0 1 4 ] "point P" [ -0.8 0.5 -0.4  0.7 0.6 -0.5  0.8 0.8 0.5  -0.6 0.7 0.4  0 1.3 0 ]
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

/// Block means of what two scenes look like, for every mix, by a z-test. One vertex a path: a light that rays
/// meet hides what is behind it from others.
void expect_alike(const std::string& a, const std::string& b, const std::vector<std::string>& mixes) {
  JobSpec spec = test::job(48, 32, mixes, 32);
  spec.max_depth = 1;
  std::vector<FilmImage> images[2];
  for (const std::string* text : {&a, &b}) {
    const ScenePtr scene = test::load_text(*text);
    ASSERT_TRUE(scene);
    images[text == &b] = test::render(*scene, spec).images;
  }
  for (size_t m = 0; m < mixes.size(); ++m) {
    std::vector<double> means[2], variance;
    const std::vector<Block> of_a = blocks(images[0][m], spec.crop), of_b = blocks(images[1][m], spec.crop);
    for (size_t k = 0; k < of_a.size(); ++k)
      for (int c = 0; c < 3; ++c) {
        means[0].push_back(of_a[k].mean[c]);
        means[1].push_back(of_b[k].mean[c]);
        variance.push_back(of_a[k].variance[c] + of_b[k].variance[c]);
      }
    const ZTest z = z_test(means[0], means[1], variance, 0.001);
    ASSERT_GT(z.compared, 0);
    EXPECT_TRUE(z.passes()) << mixes[m] << ": worst |z| " << z.largest << " of " << means[0][size_t(z.worst)]
                            << " and " << means[1][size_t(z.worst)];
  }
}

/// Above the picture, so that only what they light is seen of them.
std::string above(const std::string& shape, const std::string& alpha, const std::string& more) {
  return light("Translate 0 3.3 0 " + shape + alpha, more);
}

TEST(InvisibleLights, RoundOnesLightWhatVisibleOnesLight) {
  const std::string alpha = "\"float alpha\" 0";
  const std::vector<std::string> mixes = {"sa:4", "area:4", "bsdf:2+sa:2", "bsdf:4"};
  const std::string disk = "Rotate 100 1 0 0 Shape \"disk\" \"float radius\" 0.5 ";
  for (const std::string& shape : {sphere(), cylinder(), disk})
    for (const std::string more : {"", "\"bool twosided\" true"}) {
      SCOPED_TRACE(shape + more);
      // A visible light answers to bsdf by its own directions: those are compared in mixes_test.cpp.
      expect_alike(kHead + kBlocker + above(shape, "", more), kHead + kBlocker + above(shape, alpha, more),
                   mixes);
    }
}

const std::vector<std::string> kEveryStrategy = {"bsdf:8",
                                                 "sa:2",
                                                 "area:2",
                                                 "bsdf:1+sa:1",
                                                 "visible-area:2",
                                                 "line-area@0:2",
                                                 "line-sa@u:2",
                                                 "line-uniform@0:2",
                                                 "line-analytic@0:2",
                                                 "line-sa@v:1",
                                                 "bsdf:1+visible-area:1",
                                                 "bsdf:1+line-sa@v:1",
                                                 "sa:1+line-area@90:1/free",
                                                 "line-sa@u:1+sa:1/smooth=auto"};

TEST(LightsWithHoles, Quad) {
  test::expect_agreement(
      test::load_text(kHead + kBlocker +
                      light(R"(Shape "quad" "point o" [ -0.7 2.2 -0.5 ] "vector u" [ 1.4 0 0 ]
"vector v" [ 0 0 0.9 ] "texture alpha" "holes")")),
      kEveryStrategy, passes(64));
}

TEST(LightsWithHoles, TwoSidedTrianglesAndASphere) {
  test::expect_agreement(test::load_text(kHead + kBlocker +
                                         light(R"(Shape "trianglemesh" "integer indices" [ 0 1 2 0 2 3 ]
"point P" [ -1 1.8 -0.5  0.6 1.7 -0.4  0.8 1.6 0.8  -1 2 0.9 ] "float uv" [ 0 0 1 0 1 1 0 1 ] "texture alpha" "holes")",
                                               "\"bool twosided\" true") +
                                         light("Translate 2 0 0 " + sphere("\"texture alpha\" \"holes\""))),
                         kEveryStrategy, passes(64));
}

TEST(LightsWithHoles, OneThatMoves) {
  test::expect_agreement(
      test::load_text(kHead + kBlocker +
                      light(R"(ActiveTransform EndTime Translate 0.6 0.2 0 Rotate 20 0 1 0 ActiveTransform All
Shape "quad" "point o" [ -0.7 2.2 -0.5 ] "vector u" [ 1.4 0 0 ] "vector v" [ 0 0 0.9 ] "texture alpha" "holes")")),
      {"bsdf:8", "sa:2", "bsdf:1+sa:1", "line-sa@u:2", "line-area@0:1"}, passes(64));
}

TEST(LightsWithHoles, WhenTheirLightArrives) {
  test::AgreementSpec how = passes(64);
  how.transient = Transient{6, 12, 4};
  test::expect_agreement(
      test::load_text(kHead + kBlocker +
                      light(R"(Shape "quad" "point o" [ -0.7 2.2 -0.5 ] "vector u" [ 1.4 0 0 ]
"vector v" [ 0 0 0.9 ] "texture alpha" "holes")")),
      {"bsdf:2+sa:2", "line-sa@u:2", "line-analytic@0:2"}, how);
}

TEST(LightsWithHoles, InAFog) {
  test::AgreementSpec how = passes(32);
  how.width = 40;
  how.height = 30;
  test::expect_agreement(
      test::load_text(
          R"(MakeNamedMedium "thin" "string type" "homogeneous" "rgb sigma_a" [0.01 0.02 0.03] "rgb sigma_s" [0.1 0.1 0.1]
MediumInterface "" "thin"
)" + kHead +
          kBlocker + light(R"(Shape "quad" "point o" [ -0.7 2.2 -0.5 ] "vector u" [ 1.4 0 0 ]
"vector v" [ 0 0 0.9 ] "texture alpha" "holes")")),
      {"bsdf:2+sa:2", "sa:2", "line-sa@v:1", "sa:2/medium=line"}, how);
}

}  // namespace
}  // namespace penumbra
