// Light by the length of its path: points against lines in every bin, and both against quadrature.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/statistical/render/agreement.h"

namespace penumbra {
namespace {

test::AgreementSpec binned(const Transient& transient) {
  test::AgreementSpec how;
  how.width = 48;
  how.height = 32;
  how.tile = 16;
  how.transient = transient;
  return how;
}

/// A long light over a floor, an occluder between them, a mirror behind: chords cross many bins.
const char* const kRoom = R"(LookAt 0 3 7  0 0.8 0  0 1 0
Camera "perspective" "float fov" 45
WorldBegin
AttributeBegin AreaLightSource "diffuse" "rgb L" [ 6 5 4 ]
Shape "quad" "point o" [ -2 2.5 -1 ] "vector u" [ 4 0 0 ] "vector v" [ 0 0.5 1.5 ] AttributeEnd
Material "plastic"
AttributeBegin Translate 0.3 0.6 0 Shape "sphere" "float radius" 0.5 AttributeEnd
Material "matte" "rgb Kd" [ 0.6 0.4 0.3 ]
Shape "trianglemesh" "integer indices" [ 0 1 2 0 2 3 ] "point P" [ -4 0 -4  -4 0 4  4 0 4  4 0 -4 ]
Material "mirror"
Shape "trianglemesh" "integer indices" [ 0 1 2 0 2 3 ] "point P" [ -4 0 -3  4 0 -3  4 4 -3  -4 4 -3 ]
)";

TEST(Transient, PointsAndLinesAgreeInEveryBin) {
  test::expect_agreement(
      test::load_text(kRoom),
      {"bsdf:1+sa:2", "line-sa@u:2", "line-sa@v:2", "bsdf:1+line-sa@u:1", "line-analytic@0:2",
       "line-area@30:1+line-area@90:1/average", "bsdf:1+line-sa@v:1/free", "bsdf:1+line-area@0:1/smooth=auto",
       "bsdf:1+visible-area:1"},
      binned({6, 14, 12}));
}

TEST(Transient, WithEverySampler) {
  for (const SamplerKind sampler : {SamplerKind::kStratified, SamplerKind::kSobol}) {
    test::AgreementSpec how = binned({6, 14, 12});
    how.sampler = sampler;
    how.group = 8;
    test::expect_agreement(test::load_text(kRoom), {"bsdf:1+sa:2", "line-sa@u:2", "bsdf:1+line-sa@v:1"}, how);
  }
}

/// More lights than are asked: some are drawn, in each bin with the same chance.
TEST(Transient, WithManyLights) {
  std::string scene = R"(LookAt 0 3 7  0 0.8 0  0 1 0
Camera "perspective" "float fov" 45
WorldBegin
Material "matte"
Shape "trianglemesh" "integer indices" [ 0 1 2 0 2 3 ] "point P" [ -4 0 -4  -4 0 4  4 0 4  4 0 -4 ]
AttributeBegin Translate 0.3 0.6 0 Shape "sphere" "float radius" 0.5 AttributeEnd
LightSource "point" "point from" [ 2 3 1 ] "rgb I" [ 1 2 3 ]
)";
  for (int i = 0; i < 20; ++i)
    scene += fmt::format(
        "AttributeBegin AreaLightSource \"diffuse\" \"rgb L\" [ 6 5 4 ]\n"
        "Shape \"quad\" \"point o\" [ {} 2.5 {} ] \"vector u\" [ 0.5 0 0 ] \"vector v\" [ 0 0 0.5 ] "
        "AttributeEnd\n",
        -2 + 0.8 * (i % 5), -1.5 + 0.8 * (i / 5));
  test::expect_agreement(test::load_text(scene), {"bsdf:1+sa:1", "line-sa@u:1", "bsdf:1+line-area@0:1"},
                         binned({7, 14, 6}));
}

TEST(Transient, InFogAndThroughALens) {
  test::AgreementSpec how = binned({0, 40, 6});
  test::expect_agreement(test::load(PENUMBRA_SOURCE_DIR "/scenes/gallery/fog.pbrt"),
                         {"bsdf:1+sa:2", "sa:2/medium=line", "line-sa@v:2/medium=line"}, how);
  how.transient = Transient{0, 20, 6};
  test::expect_agreement(test::load(PENUMBRA_SOURCE_DIR "/scenes/gallery/lens.pbrt"),
                         {"bsdf:1+sa:1", "line-sa@u:1/balance/lens=line"}, how);
}

/// One point of a floor, a rectangle over it: what arrives in each bin, against a sum over 4,000 × 4,000
/// pieces of the light.
TEST(Transient, ARectangleOverAFloorAgainstQuadrature) {
  const ScenePtr scene = test::load_text(R"(LookAt 3 3 0  0 0 0  0 1 0
Camera "perspective" "float fov" 0.0005
WorldBegin
AttributeBegin AreaLightSource "diffuse" "rgb L" [ 1 1 1 ] ReverseOrientation
Shape "quad" "point o" [ -2 1.5 -1 ] "vector u" [ 0 0 3 ] "vector v" [ 3 0 0 ] AttributeEnd
Material "matte" "rgb Kd" [ 0.5 0.5 0.5 ]
Shape "trianglemesh" "integer indices" [ 0 1 2 0 2 3 ] "point P" [ -1 0 -1  -1 0 1  1 0 1  1 0 -1 ]
)");
  ASSERT_TRUE(scene);
  const Transient transient{5.5, 7.5, 16};
  const double to_camera = 3 * std::numbers::sqrt2;
  std::vector<double> expected(size_t(transient.bins), 0);
  constexpr int kPieces = 4000;
  const double piece = 9.0 / kPieces / kPieces;
  for (int i = 0; i < kPieces; ++i)
    for (int j = 0; j < kPieces; ++j) {
      const double z = -1 + 3 * (i + 0.5) / kPieces, x = -2 + 3 * (j + 0.5) / kPieces;
      const double r2 = x * x + 1.5 * 1.5 + z * z, length = to_camera + std::sqrt(r2);
      const int bin = int(std::floor((length - 5.5) / 0.125));
      if (bin >= 0 && bin < transient.bins)
        expected[size_t(bin)] += 0.5 / std::numbers::pi * 1.5 * 1.5 / (r2 * r2) * piece;
    }
  const std::vector<std::string> mixes = {
      "sa:1", "area:1", "line-sa@u:1", "line-area@30:1", "line-analytic@0:1", "bsdf:1+line-sa@v:1"};
  JobSpec spec = test::job(16, 16, mixes, 200);
  spec.transient = transient;
  const test::Rendered r = test::render(*scene, spec, 1);
  for (size_t m = 0; m < mixes.size(); ++m)
    for (size_t b = 0; b < expected.size(); ++b) {
      double sum = 0, variance = 0;
      const size_t n = 16 * 16;
      for (size_t p = 0; p < n; ++p) {
        sum += r.bins[m][b].rgb[3 * p] / double(n);
        variance += r.bins[m][b].variance[3 * p] / double(n * n);
      }
      // The quadrature's own error: pieces on a bin's edge, 1e-3 of a bin.
      const double error = 4.5 * std::sqrt(variance) + 1e-3 * expected[b];
      EXPECT_NEAR(sum, expected[b], error) << mixes[m] << ", bin " << b;
      if (b > 3 && b < 12) {
        EXPECT_GT(sum, 0);
      }
    }
}

}  // namespace
}  // namespace penumbra
