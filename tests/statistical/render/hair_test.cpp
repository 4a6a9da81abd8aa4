// Hair by points and by lines: one picture; and the coverage of strands far thinner than a pixel.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/statistical/render/agreement.h"

namespace penumbra {
namespace {

/// Strands that lean over a floor, of every type, in hair, matte and glossy; a lamp close above their tips.
std::string tuft(int strands) {
  std::mt19937 engine(5);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::string text = R"(LookAt 0 1.2 4  0 0.5 0  0 1 0
Camera "perspective" "float fov" 30
WorldBegin
AttributeBegin AreaLightSource "diffuse" "rgb L" [ 12 11 9 ]
Shape "quad" "point o" [ -0.4 1.5 -0.9 ] "vector u" [ 0.9 0 0 ] "vector v" [ 0 -0.2 0.6 ] AttributeEnd
AttributeBegin AreaLightSource "diffuse" "rgb L" [ 3 4 6 ]
Shape "quad" "point o" [ -1.6 0.4 0.4 ] "vector u" [ 0 0 -0.8 ] "vector v" [ 0 0.7 0 ] AttributeEnd
Material "matte" "rgb Kd" [ 0.6 0.55 0.5 ]
Shape "trianglemesh" "integer indices" [ 0 1 2 0 2 3 ] "point P" [ -4 0 -4  -4 0 4  4 0 4  4 0 -4 ]
MakeNamedMaterial "hair" "string type" "hair" "rgb color" [ 0.6 0.35 0.15 ] "float beta_m" 0.3
MakeNamedMaterial "straw" "string type" "matte" "rgb Kd" [ 0.5 0.45 0.2 ]
MakeNamedMaterial "wire" "string type" "plastic" "rgb Kd" [ 0.1 0.2 0.4 ] "float roughness" 0.2
)";
  const char* const materials[] = {"hair", "straw", "wire"};
  const char* const types[] = {"flat", "cylinder", "ribbon"};
  for (int i = 0; i < strands; ++i) {
    const double x = uniform(engine), z = uniform(engine), lean = 0.4 * uniform(engine),
                 turn = 0.4 * uniform(engine);
    text += fmt::format(
        "NamedMaterial \"{}\" Shape \"curve\" \"string type\" \"{}\" \"float width0\" {} \"float width1\" {} "
        "\"point P\" [ {} 0 {}  {} 0.4 {}  {} 0.7 {}  {} {} {} ] {}\n",
        materials[i % 3], types[i / 3 % 3], i % 7 == 0 ? 0.1 : 0.02, i % 7 == 0 ? 0.04 : 0.004, x, z, x, z,
        x + lean, z + turn, x + 2 * lean, 0.9 + 0.2 * turn, z + 2 * turn,
        i / 3 % 3 == 2 ? "\"normal N\" [ 0.2 0 1  1 0 0.3 ]" : "");
  }
  return text;
}

// visible-area falls back to points where strands stand before the light.
TEST(Hair, PointsAndLinesAgree) {
  test::AgreementSpec how;
  how.passes = 48;
  test::expect_agreement(test::load_text(tuft(240)),
                         {"bsdf:2+sa:2", "sa:3", "line-sa@u:2", "line-sa@v:2", "line-area@30:2",
                          "bsdf:1+line-sa@v:1", "bsdf:1+line-sa@u:1/free", "visible-area:2"},
                         how);
}

struct Grid {
  int strands;
  double width;  ///< in pixels
};

class Coverage : public testing::TestWithParam<Grid> {};

// Black strands before a lamp as wide as the picture: what is not covered is 1. From the pinhole a cylinder
// of radius r about (X, D) hides slopes m with |X - m D| <= r √(1 + m²).
TEST_P(Coverage, IsRightOnAverage) {
  constexpr int kWidth = 64, kHeight = 16, kPasses = 128;
  constexpr double kDistance = 10,
                   kHalf = 0.4;  // slopes at the picture's edges, at right angles to the strands
  const auto [strands, width] = GetParam();
  const double radius = width * (2 * kHalf * kDistance / kWidth) / 2;
  std::string text = fmt::format(R"(Camera "perspective" "float fov" {}
PixelFilter "box" "float xwidth" 0.5 "float ywidth" 0.5
WorldBegin
AttributeBegin AreaLightSource "diffuse" "rgb L" [ 1 1 1 ] "bool twosided" "true" Material "matte" "rgb Kd" [ 0 0 0 ]
Shape "quad" "point o" [ -50 -50 20 ] "vector u" [ 100 0 0 ] "vector v" [ 0 100 0 ] AttributeEnd
Material "matte" "rgb Kd" [ 0 0 0 ]
)",
                                 2 * std::atan(kHalf / 4) * 180 / M_PI);
  double covered = 0;
  for (int i = 0; i < strands; ++i) {
    // Unequal steps, so that no film pattern falls in with them; no two of them overlap.
    const double x = kDistance * kHalf * ((2 * i + 1 + 0.3 * std::sin(7. * i)) / strands - 1);
    text += fmt::format(
        "Shape \"curve\" \"float width\" {} \"string type\" \"{}\" \"point P\" [ {} -9 10 {} -3 10 {} 3 10 "
        "{} 9 10 ]\n",
        2 * radius, i % 2 ? "flat" : "cylinder", x, x, x, x);
    covered += 2 * radius * std::sqrt(x * x + kDistance * kDistance - radius * radius) /
               (kDistance * kDistance - radius * radius);
  }
  covered /= 2 * kHalf;
  const ScenePtr scene = test::load_text(text);
  ASSERT_TRUE(scene);
  const JobSpec job = test::job(kWidth, kHeight, {"sa:1"}, kPasses);
  const test::Rendered rendered = test::render(*scene, job);
  const FilmImage& image = rendered.images[0];
  double mean = 0, variance = 0;
  const auto pixels = static_cast<double>(image.pixels());
  for (size_t i = 0; i < image.rgb.size(); i += 3) {
    mean += image.rgb[i] / pixels;
    variance += image.variance[i] / (pixels * pixels);
  }
  EXPECT_LT(std::abs(mean - (1 - covered)), 4 * std::sqrt(variance))
      << "covered " << 1 - mean << ", should be " << covered << " ± " << std::sqrt(variance);
  EXPECT_LT(std::sqrt(variance), covered / 20) << "the test sees too little";
}

INSTANTIATE_TEST_SUITE_P(All, Coverage,
                         testing::Values(Grid{64, 0.01}, Grid{200, 0.01}, Grid{40, 0.1}, Grid{12, 3.}));

}  // namespace
}  // namespace penumbra
