// The gallery's hard cases end to end: no value that is not finite, every strategy agrees with every other,
// and no light passes through a closed box.
//
// A z-test needs means that a few thousand samples can estimate. Where a strategy alone has no finite
// variance
// (`area` at a light that x touches: ∫ (cosθ cosθ_l / r²)² dA over a pixel diverges) or never meets the light
// (`bsdf` and a light of 1e-12 sr), it stands in a balanced mix with one that has: its samples and densities
// enter the estimate all the same.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "tests/statistical/render/agreement.h"

namespace penumbra {
namespace {

ScenePtr hard_scene(const std::string& name) {
  return test::load(PENUMBRA_SOURCE_DIR "/scenes/gallery/hard/" + name + ".pbrt");
}

/// One of each kind, alone and combined.
const std::vector<std::string> kEveryStrategy = {"bsdf:4",
                                                 "area:2",
                                                 "sa:2",
                                                 "line-area@0:1",
                                                 "line-area@90:1",
                                                 "line-area@37:1",
                                                 "line-sa@u:1",
                                                 "line-sa@v:1",
                                                 "line-uniform@20:1",
                                                 "line-analytic@0:1",
                                                 "bsdf:1+sa:1",
                                                 "area:1+line-sa@v:1",
                                                 "bsdf:1+line-sa@u:1/power",
                                                 "sa:1+line-area@60:1/free",
                                                 "line-area@0:1+line-sa@v:1/average",
                                                 "visible-area:2",
                                                 "bsdf:1+visible-area:1",
                                                 "visible-area:1+line-sa@u:1",
                                                 "sa:1+visible-area:1/power"};

test::AgreementSpec small(int64_t passes) {
  test::AgreementSpec how;
  how.width = 48;
  how.height = 36;
  how.passes = passes;
  return how;
}

TEST(HardScenes, Slivers) {
  test::expect_agreement(hard_scene("slivers"), kEveryStrategy, small(32));
}

TEST(HardScenes, CoplanarStacks) {
  test::expect_agreement(hard_scene("stacks"), kEveryStrategy, small(32));
}

TEST(HardScenes, CoversCloseToTheirLight) {
  test::expect_agreement(hard_scene("covered"), kEveryStrategy, small(32));
}

TEST(HardScenes, LightAtAGrazingAngle) {
  std::vector<std::string> mixes = kEveryStrategy;
  mixes[0] = "bsdf:3+sa:1";  // a light under 1e-3 rad is not met by chance
  test::expect_agreement(hard_scene("grazing"), mixes, small(32));
}

TEST(HardScenes, ReceiverTouchesTheLight) {
  test::expect_agreement(
      hard_scene("touching"),
      {"bsdf:4", "sa:2", "line-sa@u:1", "line-sa@v:1", "area:1+sa:1", "bsdf:1+sa:1", "sa:1+line-area@0:1",
       "sa:1+line-area@90:1", "sa:1+line-area@37:1", "sa:1+line-uniform@20:1", "line-analytic@0:1",
       "bsdf:1+line-sa@v:1", "sa:1+line-sa@u:1/free", "bsdf:1+line-sa@u:1/power", "visible-area:2",
       "bsdf:1+visible-area:1"},
      small(32));
}

TEST(HardScenes, LightInTheReceiversPlane) {
  test::expect_agreement(hard_scene("in_plane"), kEveryStrategy, small(32));
}

TEST(HardScenes, TinyLight) {
  test::expect_agreement(
      hard_scene("tiny"),
      {"area:1", "sa:1", "line-area@0:1", "line-area@90:1", "line-area@37:1", "line-sa@u:1", "line-sa@v:1",
       "line-uniform@20:1", "line-analytic@0:1", "bsdf:1+sa:1", "bsdf:1+line-sa@u:1",
       "area:1+line-sa@v:1/power", "bsdf:1+line-area@0:1/free", "line-area@0:1+line-sa@v:1/average",
       "visible-area:1", "area:1+visible-area:1"},
      small(16));
}

TEST(HardScenes, MillimetresAThousandKilometresAway) {
  test::expect_agreement(hard_scene("far"), kEveryStrategy, small(32));
}

TEST(HardScenes, TenThousandSlats) {
  test::AgreementSpec how = small(4);
  how.width = 32;
  how.height = 24;
  test::expect_agreement(hard_scene("blinds"),
                         {"bsdf:4", "area:4", "sa:4", "line-area@0:1", "line-area@90:1", "line-sa@u:1",
                          "line-sa@v:1", "line-uniform@20:1", "line-analytic@0:1", "bsdf:1+line-sa@v:1",
                          "visible-area:2", "bsdf:1+visible-area:1"},
                         how);
}

/// A plate of reflectance 1/2 in a room whose walls all shine with radiance 1 shines with 1/2, whatever the
/// strategy: samples, densities and visibility end to end, against a number that no strategy gave.
TEST(HardScenes, FurnaceOfSixLights) {
  std::string text = R"(LookAt 0.1 0.6 0.2  -0.1 -0.7 0  0 0 1
Camera "perspective" "float fov" 35
WorldBegin
Material "matte" "rgb Kd" [ 0.5 0.5 0.5 ]
Shape "trianglemesh" "integer indices" [ 0 1 2 0 2 3 ] "point P" [ -0.9 -0.705 -0.9  -0.9 -0.795 0.9  0.9 -0.795 0.9  0.9 -0.705 -0.9 ]
AreaLightSource "diffuse" "rgb L" [ 1 1 1 ]
Material "matte" "rgb Kd" [ 0 0 0 ]
)";
  // Corner and edges of each wall of [-1,1]³; u × v points inwards.
  for (const char* wall : {"[ -1 -1 -1 ] \"vector u\" [ 2 0 0 ] \"vector v\" [ 0 2 0 ]",
                           "[ -1 -1 1 ] \"vector u\" [ 0 2 0 ] \"vector v\" [ 2 0 0 ]",
                           "[ -1 -1 -1 ] \"vector u\" [ 0 2 0 ] \"vector v\" [ 0 0 2 ]",
                           "[ 1 -1 -1 ] \"vector u\" [ 0 0 2 ] \"vector v\" [ 0 2 0 ]",
                           "[ -1 -1 -1 ] \"vector u\" [ 0 0 2 ] \"vector v\" [ 2 0 0 ]",
                           "[ -1 1 -1 ] \"vector u\" [ 2 0 0 ] \"vector v\" [ 0 0 2 ]"})
    text += std::string("Shape \"quad\" \"point o\" ") + wall + "\n";
  const ScenePtr scene = test::load_text(text);
  ASSERT_TRUE(scene);
  const JobSpec spec = test::job(32, 32, kEveryStrategy, 16);
  const test::Rendered rendered = test::render(*scene, spec);
  for (size_t m = 0; m < spec.mixes.size(); ++m) {
    const FilmImage& image = rendered.images[m];
    double mean = 0, variance = 0;
    for (size_t i = 0; i < image.rgb.size(); i += 3) {
      mean += image.rgb[i];
      variance += image.variance[i];
    }
    const double n = static_cast<double>(image.rgb.size()) / 3, error = std::sqrt(variance) / n;
    EXPECT_LT(std::abs(mean / n - 0.5), 4.5 * error + 1e-6) << kEveryStrategy[m];
    EXPECT_LT(error, 0.02) << kEveryStrategy[m];
    EXPECT_EQ(rendered.costs[m].non_finite, 0u) << kEveryStrategy[m];
  }
}

/// A light with a cover `before` it that is larger than it, from all sides of which nothing may pass.
std::string covered_light(const Vec3d& o, const Vec3d& u, const Vec3d& v, double before) {
  const Vec3d n = u.cross(v).normalized();
  const auto point = [](const Vec3d& p) {
    char text[100];
    std::snprintf(text, sizeof text, "%.9g %.9g %.9g ", double(float(p.x)), double(float(p.y)),
                  double(float(p.z)));
    return std::string(text);
  };
  const Vec3d c = o + n * before, eye = o + n * 0.6 + u * 3.0, at = o + n * 1.3;
  std::string text = "LookAt " + point(eye) + point(at) + point(n) + R"(
Camera "perspective" "float fov" 60
WorldBegin
Material "matte" "rgb Kd" [ 0.5 0.5 0.5 ]
Shape "trianglemesh" "integer indices" [ 0 1 2 0 2 3 ] "point P" [ )";
  for (const auto& [s, t] : {std::pair{-4, -4}, {5, -4}, {5, 5}, {-4, 5}})  // the receiver, across the way
    text += point(o + n * 1.3 + u * double(s) + v * double(t) + n * (0.1 * s));
  text += "]\nShape \"trianglemesh\" \"integer indices\" [ 0 1 2 0 2 3 ] \"point P\" [ ";
  for (const auto& [s, t] : {std::pair{-3, -3}, {4, -3}, {4, 4}, {-3, 4}})
    text += point(c + u * double(s) + v * double(t));
  return text + "]\nAreaLightSource \"diffuse\" \"rgb L\" [ 100 100 100 ]\nShape \"quad\" \"point o\" [ " +
         point(o) + "] \"vector u\" [ " + point(u) + "] \"vector v\" [ " + point(v) + "]\n";
}

/// Covers 1e-6 of the light's distance before it, or of its coordinates where those are larger.
TEST(HardScenes, AClosedCoverCloseToItsLightIsBlack) {
  const Vec3d u(0.6, 0, 0.8), v(0.32, 0.916515139, -0.24);
  for (const Vec3d& o : {Vec3d(0.1, -0.2, 0.3), Vec3d(30, -20, 10)})
    for (const bool oblique : {false, true}) {
      const double before = 1e-6 * (2 + o.length());
      const ScenePtr scene = test::load_text(oblique ? covered_light(o, u, v, before)
                                                     : covered_light(o, {1, 0, 0}, {0, 1, 0}, before));
      ASSERT_TRUE(scene);
      const JobSpec spec = test::job(24, 24, kEveryStrategy, 8);
      const test::Rendered rendered = test::render(*scene, spec);
      for (size_t m = 0; m < spec.mixes.size(); ++m) {
        const auto& rgb = rendered.images[m].rgb;
        EXPECT_EQ(*std::max_element(rgb.begin(), rgb.end()), 0)
            << kEveryStrategy[m] << " sees through a cover";
      }
      // Without it there is light: the test looks at something.
      const ScenePtr open = test::load_text(covered_light(o, u, v, -1));
      const auto lit = test::render(*open, test::job(24, 24, {"sa:1"}, 1)).images[0].rgb;
      EXPECT_GT(*std::max_element(lit.begin(), lit.end()), 0);
    }
}

TEST(HardScenes, AClosedBoxIsBlack) {
  const ScenePtr scene = hard_scene("closed_box");
  ASSERT_TRUE(scene);
  for (const SamplerKind sampler :
       {SamplerKind::kIndependent, SamplerKind::kStratified, SamplerKind::kSobol}) {
    JobSpec spec = test::job(64, 48, kEveryStrategy, 8);
    spec.sampler = sampler;
    const test::Rendered rendered = test::render(*scene, spec, 8);
    for (size_t m = 0; m < spec.mixes.size(); ++m) {
      EXPECT_EQ(rendered.costs[m].non_finite, 0u) << kEveryStrategy[m];
      float brightest = 0;
      for (const float value : rendered.images[m].rgb) brightest = std::max(brightest, value);
      EXPECT_EQ(brightest, 0) << kEveryStrategy[m] << " lets light into the box";
    }
  }
}

}  // namespace
}  // namespace penumbra
