// Lines across the pixel against points: one picture, and what the lines know.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <random>

#include "tests/statistical/render/agreement.h"

namespace penumbra {
namespace {

const std::vector<std::string> kMixes = {"sa:1", "bsdf:1+sa:1/balance/pixel=line", "sa:1/balance/pixel=line",
                                         "line-sa@u:1/balance/pixel=line"};

/// Strands thinner than a pixel over a floor, a ball that cuts them, an instance, a light in view.
std::string tuft(const char* filter) {
  std::mt19937 engine(8);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::string text = fmt::format(R"(LookAt 0 1.2 4  0 0.5 0  0 1 0
Camera "perspective" "float fov" 30
PixelFilter {}
WorldBegin
AttributeBegin AreaLightSource "diffuse" "rgb L" [ 9 8 6 ]
Shape "quad" "point o" [ -0.4 1.3 -0.9 ] "vector u" [ 0.9 0 0 ] "vector v" [ 0 -0.2 0.6 ] AttributeEnd
Material "matte" "rgb Kd" [ 0.6 0.55 0.5 ]
Shape "trianglemesh" "integer indices" [ 0 1 2 0 2 3 ] "point P" [ -4 0 -4  -4 0 4  4 0 4  4 0 -4 ]
AttributeBegin Translate 0.5 0.3 0.2 Shape "sphere" "float radius" 0.25 AttributeEnd
ObjectBegin "o" Material "plastic" Shape "sphere" "float radius" 0.2 ObjectEnd
AttributeBegin Translate -0.6 0.3 0.1 Scale 1 1.5 0.7 ObjectInstance "o" AttributeEnd
MakeNamedMaterial "hair" "string type" "hair" "rgb color" [ 0.6 0.35 0.15 ] "float beta_m" 0.3
)",
                                 filter);
  for (int i = 0; i < 150; ++i) {
    const double x = uniform(engine), z = uniform(engine), lean = 0.4 * uniform(engine);
    text += fmt::format(
        "NamedMaterial \"hair\" Shape \"curve\" \"string type\" \"{}\" \"float width\" {} \"point P\" [ {} 0 "
        "{}  "
        "{} 0.4 {}  {} 0.7 {}  {} 0.9 {} ]\n",
        i % 2 == 0 ? "flat" : "cylinder", i % 7 == 0 ? 0.06 : 0.008, x, z, x, z, x + lean, z, x + 2 * lean,
        z + lean);
  }
  return text;
}

TEST(PixelLines, AgreeWithPoints) {
  test::AgreementSpec how;
  how.width = 48;
  how.height = 36;
  how.passes = 48;
  for (const char* filter :
       {"\"box\"", "\"mitchell\"", "\"gaussian\" \"float xwidth\" 1.5 \"float ywidth\" 0.8"}) {
    SCOPED_TRACE(filter);
    test::expect_agreement(test::load_text(tuft(filter)), kMixes, how);
  }
}

/// Where a lens or a moving thing is, lines are points of the film: the same numbers.
TEST(PixelLines, ArePointsWhereThereIsALens) {
  std::string text = tuft("\"box\"");
  text.insert(text.find("\"float fov\""), "\"float lensradius\" 0.05 \"float focaldistance\" 4 ");
  const ScenePtr scene = test::load_text(text);
  const auto picture = [&](const char* mix) {
    return test::render(*scene, test::job(16, 12, {mix}, 2)).images[0].rgb;
  };
  EXPECT_EQ(picture("sa:1"), picture("sa:1/balance/pixel=line"));
}

/// Black things before a sky (a lamp's pixels would have rays of their own): all that varies is what they
/// cover, and along lines that is known. Strands across the picture, in all directions, and the edge of a
/// plate.
TEST(PixelLines, KnowCoverageAlongThemselves) {
  std::string text = R"(LookAt 0 0 0  0 0 1  0 1 0
Camera "perspective" "float fov" 90
PixelFilter "box" "float xwidth" 0.5 "float ywidth" 0.5
WorldBegin
LightSource "infinite" "rgb L" [1 1 1]
Material "matte" "rgb Kd" [0 0 0]
Shape "trianglemesh" "integer indices" [0 1 2 0 2 3] "point P" [-9 -9 3.5  -1.37 -9 3.5  -1.37 9 3.5  -9 9 3.5]
)";
  std::mt19937 engine(3);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int i = 0; i < 60; ++i) {
    const double x = 3 * uniform(engine), y = 3 * uniform(engine), dx = uniform(engine), dy = uniform(engine);
    text += fmt::format(
        "Shape \"curve\" \"float width\" 0.03 \"point P\" [ {} {} 3  {} {} 3  {} {} 3  {} {} 3 ]\n", x, y,
        x + dx, y + dy, x + 2 * dx, y + 2 * dy, x + 3 * dx, y + 3 * dy);
  }
  const ScenePtr scene = test::load_text(text);
  ASSERT_TRUE(scene);
  const test::Rendered pictures =
      test::render(*scene, test::job(24, 24, {"sa:1", "sa:1/balance/pixel=line"}, 64));
  double sums[2] = {0, 0}, variances[2] = {0, 0};
  for (int m = 0; m < 2; ++m)
    for (size_t i = 0; i < pictures.images[size_t(m)].rgb.size(); i += 3) {
      sums[m] += double(pictures.images[size_t(m)].rgb[i]);
      variances[m] += double(pictures.images[size_t(m)].variance[i]);
    }
  EXPECT_LT(std::abs(sums[0] - sums[1]), 4.5 * std::sqrt(variances[0] + variances[1]));
  EXPECT_LT(variances[1], 0.4 * variances[0]);
}

}  // namespace
}  // namespace penumbra
