// Light from infinitely far away: points against quarters of great circles.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "film/exr.h"
#include "tests/statistical/render/agreement.h"
#include "tests/statistical/render/sky_map.h"

namespace penumbra {
namespace {

namespace fs = std::filesystem;

const char* const kOverAFloor = R"(
Material "matte"
Shape "trianglemesh" "integer indices" [ 0 1 2 0 2 3 ] "point P" [ -4 0 -4  -4 0 4  4 0 4  4 0 -4 ]
Material "plastic"
AttributeBegin Translate 0 0.8 0 Shape "sphere" "float radius" 0.6 AttributeEnd
Material "matte" "rgb Kd" [ 0.7 0.5 0.3 ]
Shape "trianglemesh" "integer indices" [ 0 1 2 0 2 3 ] "point P" [ -3 0 -1.5  3 0 -1.5  3 2 -1.5  -3 2 -1.5 ]
)";

const char* const kCamera = R"(LookAt 0 2.5 6  0 0.5 0  0 1 0
Camera "perspective" "float fov" 42
WorldBegin
)";

class EnvironmentLines : public testing::Test {
 protected:
  EnvironmentLines()
      : folder_(
            fs::path(testing::TempDir()) /
            (std::string("penumbra-sky-") + testing::UnitTest::GetInstance()->current_test_info()->name())) {
    fs::create_directories(folder_);
  }
  ~EnvironmentLines() override { fs::remove_all(folder_); }

  /// A dim map with some texels of its own brightness.
  void write_map(int width, int height, const std::vector<std::tuple<int, int, float>>& bright) const {
    test::write_sky_map(folder_ / "map.exr", width, height, bright);
  }
  ScenePtr scene(const std::string& light, const std::string& shapes = kOverAFloor,
                 const std::string& camera = kCamera) const {
    std::ofstream(folder_ / "scene.pbrt") << camera << light << shapes;
    return test::load(folder_ / "scene.pbrt");
  }
  static test::AgreementSpec how() {
    test::AgreementSpec how;
    how.width = 48;
    how.height = 32;
    how.tile = 16;
    return how;
  }
  fs::path folder_;
};

const std::vector<std::string> kEveryMix = {"bsdf:1+sa:2",
                                            "sa:3",
                                            "line-sa@u:2",
                                            "line-sa@v:2",
                                            "bsdf:1+line-sa@v:1",
                                            "sa:1+line-sa@u:1/power",
                                            "line-sa@u:1+line-sa@v:1",
                                            "line-sa@u:1+line-sa@v:1/average",
                                            "bsdf:1+line-sa@u:1/free"};
/// Without those that find a sun by the cosine alone.
const std::vector<std::string> kForSuns = {"bsdf:1+sa:2",          "sa:3",
                                           "line-sa@v:2",          "bsdf:1+line-sa@v:1",
                                           "sa:1+line-sa@u:1",     "line-sa@v:1+line-sa@u:1",
                                           "sa:1+line-sa@v:1/free"};

TEST_F(EnvironmentLines, AConstantSkyOverAnOccluder) {
  test::expect_agreement(scene("LightSource \"infinite\" \"rgb L\" [ 0.5 0.7 1 ]\n"), kEveryMix, how());
}

TEST_F(EnvironmentLines, ADimMapTurnedAndMirrored) {
  write_map(16, 8, {{3, 2, 6.f}});
  test::expect_agreement(scene("AttributeBegin Rotate 37 1 2 3 Scale -1 1 1\n"
                               "LightSource \"infinite\" \"string mapname\" \"map.exr\" AttributeEnd\n"),
                         kEveryMix, how());
}

TEST_F(EnvironmentLines, ASunlikeTexel) {
  write_map(64, 32, {{9, 6, 1e5f}});
  test::expect_agreement(scene("AttributeBegin Rotate -90 1 0 0\n"
                               "LightSource \"infinite\" \"string mapname\" \"map.exr\" AttributeEnd\n"),
                         kForSuns, how());
}

TEST_F(EnvironmentLines, SunsAtThePolesAndOnTheEquator) {
  // Odd and few rows: the equator halves one.
  write_map(9, 5, {{0, 0, 50.f}, {4, 4, 80.f}, {8, 2, 30.f}});
  for (const char* turn : {"", "Rotate -90 1 0 0\n", "Rotate 90 1 0 0\n"})
    test::expect_agreement(scene(std::string("AttributeBegin ") + turn +
                                 "LightSource \"infinite\" \"string mapname\" \"map.exr\" AttributeEnd\n"),
                           kForSuns, how());
}

TEST_F(EnvironmentLines, AnEqualAreaMap) {
  write_map(24, 24, {{7, 11, 300.f}});
  test::expect_agreement(scene("AttributeBegin Rotate -90 1 0 0\n"
                               "LightSource \"infinite\" \"string filename\" \"map.exr\" AttributeEnd\n"),
                         kForSuns, how());
}

TEST_F(EnvironmentLines, ThroughWhatTransmitsAndBehindCutOuts) {
  write_map(16, 8, {{3, 2, 20.f}});
  test::expect_agreement(
      scene(
          "LightSource \"infinite\" \"string mapname\" \"map.exr\"\n",
          R"(Texture "holes" "float" "checkerboard" "float uscale" 4 "float vscale" 4 "float tex1" 0 "float tex2" 1
Material "translucent"
Shape "trianglemesh" "integer indices" [ 0 1 2 0 2 3 ] "point P" [ -4 0 -4  -4 0 4  4 0 4  4 0 -4 ]
Material "matte"
Shape "trianglemesh" "texture alpha" "holes" "integer indices" [ 0 1 2 0 2 3 ]
  "point P" [ -1 0 1  1 0 1.2  1 2 1.2  -1 2 1 ] "float uv" [ 0 0 1 0 1 1 0 1 ]
)"),
      kForSuns, how());
}

/// Beside an area light, lines are that light's: as many of them with a sky as without.
TEST_F(EnvironmentLines, BesideAnAreaLightTheSkyHasPoints) {
  const std::string lamp = R"(AttributeBegin AreaLightSource "diffuse" "rgb L" [ 3 2 1 ]
Shape "quad" "point o" [ -1 2.5 -1 ] "vector u" [ 2 0 0 ] "vector v" [ 0 0 1 ] AttributeEnd
)";
  const std::string sky = "LightSource \"infinite\" \"rgb L\" [ 0.5 0.7 1 ]\n";
  const auto lines = [&](const std::string& lights) {
    const ScenePtr made = scene(lights);
    return test::render(*made, test::job(16, 12, {"line-sa@u:1"}, 4)).costs[0].line_queries;
  };
  EXPECT_GT(lines(sky), 0u);
  EXPECT_GT(lines(lamp), 0u);
  EXPECT_EQ(lines(lamp + sky), lines(lamp));
}

TEST_F(EnvironmentLines, AFogUnderASky) {
  test::AgreementSpec less = how();
  less.width = 32;
  test::expect_agreement(
      scene(R"(MakeNamedMedium "fog" "string type" "homogeneous" "rgb sigma_a" [ 0.1 0.1 0.1 ]
  "rgb sigma_s" [ 0.3 0.3 0.3 ]
LightSource "infinite" "rgb L" [ 0.5 0.7 1 ]
AttributeBegin MediumInterface "fog" "" Material "interface"
Shape "sphere" "float radius" 2 AttributeEnd
)"),
      {"bsdf:1+sa:1", "line-sa@u:1", "line-sa@v:1", "bsdf:1+line-sa@u:1"}, less);
}

/// Points of the fog lie farther from the ball than everything solid is large.
TEST_F(EnvironmentLines, AFogInTheShadowOfABall) {
  FilmImage map;
  map.width = 64;
  map.height = 32;
  map.window = {0, 0, 64, 32};
  for (int i = 0; i < 64 * 32 * 3; ++i) map.rgb.push_back(i < 64 * 3 ? 100.f : 0.f);  // about +z alone
  ASSERT_TRUE(write_exr(folder_ / "map.exr", map, {}).ok());
  const ScenePtr made =
      scene(R"(LightSource "infinite" "string mapname" "map.exr"
)",
            R"(AttributeBegin MediumInterface "m" "" Material "interface"
Shape "sphere" "float radius" 20 AttributeEnd
MediumInterface "m" "m"
Material "matte" "rgb Kd" [0 0 0]
AttributeBegin Translate 0 0 3 Shape "sphere" "float radius" 0.5 AttributeEnd
)",
            R"(MakeNamedMedium "m" "string type" "homogeneous" "rgb sigma_a" [0.01 0.01 0.01]
  "rgb sigma_s" [0.1 0.1 0.1]
MediumInterface "" "m"
LookAt 0 0 0  0 0 1  0 1 0
Camera "perspective" "float fov" 2
WorldBegin
)");
  ASSERT_TRUE(made);
  const std::vector<std::string> mixes = {"sa:2",
                                          "bsdf:4",
                                          "bsdf:1+sa:1",
                                          "line-sa@v:1",
                                          "line-sa@u:2",
                                          "sa:1+line-sa@v:1/free",
                                          "sa:2/medium=line"};
  const test::Rendered rendered = test::render(*made, test::job(8, 8, mixes, 16));
  for (size_t m = 0; m < mixes.size(); ++m)
    for (const float value : rendered.images[m].rgb) ASSERT_EQ(value, 0) << mixes[m];
}

/// The map's directions are drawn out along one axis: so are their solid angles.
TEST_F(EnvironmentLines, AMapUnderAScaleThatIsNotUniform) {
  write_map(16, 8, {{3, 2, 6.f}});
  for (const char* name : {"mapname", "filename"})
    for (const char* placement : {"Scale 1 1 3", "Rotate 37 1 2 3 Scale -1 0.4 2 Rotate 20 0 1 0"})
      test::expect_agreement(
          scene(std::string("AttributeBegin ") + placement + "\nLightSource \"infinite\" \"string " + name +
                "\" \"map.exr\" AttributeEnd\n"),
          kEveryMix, how());
}

/// A surface that reflects all of a constant sky is as bright as that.
TEST_F(EnvironmentLines, AFurnaceUnderAScaleThatIsNotUniform) {
  FilmImage map;
  map.width = 2;
  map.height = 1;
  map.window = {0, 0, 2, 1};
  map.rgb.assign(6, 0.5f);
  ASSERT_TRUE(write_exr(folder_ / "map.exr", map, {}).ok());
  const ScenePtr made = scene(
      "AttributeBegin Scale 1 1 3\nLightSource \"infinite\" \"string mapname\" \"map.exr\" AttributeEnd\n",
      R"(Material "matte" "rgb Kd" [ 1 1 1 ]
Shape "trianglemesh" "integer indices" [ 0 1 2 0 2 3 ] "point P" [ -99 0 -99  -99 0 99  99 0 99  99 0 -99 ]
)",
      "LookAt 0 2.5 6  0 0.5 0  0 1 0\nCamera \"perspective\" \"float fov\" 5\nWorldBegin\n");
  ASSERT_TRUE(made);
  const std::vector<std::string> mixes = {"bsdf:4", "sa:4", "bsdf:1+sa:1", "line-sa@v:1"};
  JobSpec spec = test::job(16, 16, mixes, 64);
  const test::Rendered rendered = test::render(*made, spec);
  for (size_t m = 0; m < mixes.size(); ++m) {
    double mean = 0, variance = 0;
    const FilmImage& image = rendered.images[m];
    for (size_t i = 0; i < image.rgb.size(); i += 3) {
      mean += image.rgb[i] / double(image.pixels());
      variance += image.variance[i] / double(image.pixels() * image.pixels());
    }
    EXPECT_LE(std::abs(mean - 0.5), 4.5 * std::sqrt(variance) + 1e-5) << mixes[m] << ": " << mean;
  }
}

}  // namespace
}  // namespace penumbra
