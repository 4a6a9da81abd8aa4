// What is seen through a portal: where its samples fall, and that all ways of finding light through it agree.
#include "worker/effects/portal.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <numbers>

#include "film/exr.h"
#include "film/statistics.h"
#include "tests/statistical/lights/statistics.h"
#include "tests/statistical/render/agreement.h"
#include "tests/statistical/render/sky_map.h"

namespace penumbra {
namespace {

namespace fs = std::filesystem;
using statistical::chi_square_sigmas;
using statistical::MeanTest;
using statistical::random_square;

constexpr double kSigmas = 4.5;

std::shared_ptr<Portal> portal(std::vector<double> corners, bool with_table) {
  Param param;
  param.numbers = std::move(corners);
  SceneDescription description;
  description.files = {"scene.pbrt"};
  auto made = Portal::build(param, description);
  EXPECT_TRUE(made.ok()) << made.status();
  if (with_table) {
    std::vector<double> values;
    for (int i = 0; i < 24 * 24; ++i) values.push_back(0.05 + random_square(9, uint64_t(i)).y);
    values[24 * 12 + 13] = 40;
    (*made)->set_table(WindowTable(24, 24, values));
  }
  return *std::move(made);
}

/// A window of 3 × 2 in the plane z = 0; the room is where z > 0.
const std::vector<double> kWindow = {-1, 1, 0, 2, 1, 0, 2, 3, 0, -1, 3, 0};
const std::vector<Vec3d> kSeenFrom = {{0.5, 2, 2}, {5, 0, 0.3}, {0, 1.2, 0.2}, {-30, 8, 60}, {0.2, 1, 1}};

/// ∫ pdf dω over each cell of the window, by a midpoint rule.
std::vector<double> probabilities(const SeenPortal& seen, const Vec3d& x, int cells, int points) {
  std::vector<double> out;
  for (int i = 0; i < cells; ++i)
    for (int j = 0; j < cells; ++j) {
      double sum = 0;
      for (int k = 0; k < points * points; ++k) {
        const double s = (i + (k % points + 0.5) / points) / cells,
                     t = (j + (k / points + 0.5) / points) / cells;
        const Vec3d d = Vec3d(-1 + 3 * s, 1 + 2 * t, 0) - x;
        sum += seen.pdf(d.normalized()) * x.z / std::pow(d.length(), 3);
      }
      out.push_back(sum * 6 / (cells * cells * points * points));
    }
  return out;
}

TEST(Portal, SamplesFallWhereTheDensitySays) {
  constexpr int kCells = 8, kSamples = 40000;
  for (const bool with_table : {false, true}) {
    const auto made = portal(kWindow, with_table);
    const Portal& window = *made;
    for (const Vec3d& x : kSeenFrom) {
      const SeenPortal seen(window, x);
      const std::vector<double> probability = probabilities(seen, x, kCells, 96);
      double total = 0;
      for (const double p : probability) total += p;
      EXPECT_NEAR(total, 1, 0.01) << x;
      std::vector<int> hits(probability.size(), 0);
      MeanTest inverse;
      for (int n = 0; n < kSamples; ++n) {
        const SeenPortal::Sample s = seen.sample(random_square(4, uint64_t(n)));
        ASSERT_GT(s.pdf, 0);
        ASSERT_NEAR(s.w.length(), 1, 1e-12);
        const Vec3d p = x - s.w * (x.z / s.w.z);
        const auto cell = [](double f) { return std::clamp(int(f * kCells), 0, kCells - 1); };
        ++hits[size_t(cell((p.x + 1) / 3) * kCells + cell((p.y - 1) / 2))];
        inverse.add(1 / s.pdf);
        if (n % 100 == 0 && window.passes(x, s.w)) {
          EXPECT_NEAR(seen.pdf(s.w) / s.pdf, 1, 1e-6);
        }
      }
      // The midpoint rule is off by some points at the edges of the table's cells.
      EXPECT_LT(chi_square_sigmas(hits, probability), kSigmas + (with_table ? 2 : 0)) << x << with_table;
      // Over all directions through the window 1/pdf has the solid angle as its mean.
      if (with_table)
        EXPECT_LT(std::abs(inverse.sigmas(seen.solid_angle())), kSigmas) << x;
      else
        EXPECT_NEAR(inverse.mean() / seen.solid_angle(), 1, 1e-9);
    }
  }
}

TEST(Portal, BehindItNothingIsSeen) {
  const auto made = portal(kWindow, true);
  const Portal& window = *made;
  for (const Vec3d& x : {Vec3d(0.5, 2, -2), Vec3d(0.5, 2, 0)}) {
    const SeenPortal seen(window, x);
    EXPECT_EQ(seen.sample({0.3, 0.4}).pdf, 0);
    EXPECT_FALSE(seen.choose_chord(true, 0.5, 10).scale > 0);
    for (const double z : {1., -1.}) {
      EXPECT_EQ(seen.pdf({0, 0, z}), 0);
      EXPECT_FALSE(window.passes(x, {0, 0, z}));
    }
  }
  EXPECT_TRUE(window.passes({0.5, 2, 2}, {0, 0, -1}));
  EXPECT_FALSE(window.passes({0.5, 2, 2}, {0, 0, 1}));
  EXPECT_FALSE(window.passes({5, 2, 2}, {0, 0, -1}));
}

/// A room with one window in the wall behind, a table, and a bar outside.
const char* const kRoom = R"(
Material "matte" "rgb Kd" [ 0.7 0.7 0.7 ]
Shape "trianglemesh" "integer indices" [ 0 1 2 0 2 3 ] "point P" [ -3 0 0  -3 0 6  3 0 6  3 0 0 ]
Shape "trianglemesh" "integer indices" [ 0 1 2 0 2 3 ] "point P" [ -3 0 0  -3 4 0  -3 4 6  -3 0 6 ]
Shape "trianglemesh" "integer indices" [ 0 1 2 0 2 3 ] "point P" [ -3 0 -0.01  3 0 -0.01  3 1 -0.01  -3 1 -0.01 ]
Shape "trianglemesh" "integer indices" [ 0 1 2 0 2 3 ] "point P" [ -3 3 -0.01  3 3 -0.01  3 4 -0.01  -3 4 -0.01 ]
Shape "trianglemesh" "integer indices" [ 0 1 2 0 2 3 ] "point P" [ -3 1 -0.01  -1 1 -0.01  -1 3 -0.01  -3 3 -0.01 ]
Shape "trianglemesh" "integer indices" [ 0 1 2 0 2 3 ] "point P" [ 2 1 -0.01  3 1 -0.01  3 3 -0.01  2 3 -0.01 ]
Shape "trianglemesh" "integer indices" [ 0 1 2 0 2 3 ] "point P" [ 0.3 0 -2  0.7 0 -2  0.7 4 -2  0.3 4 -2 ]
Material "plastic" "rgb Kd" [ 0.3 0.2 0.1 ]
AttributeBegin Translate 0 0.8 2 Shape "sphere" "float radius" 0.6 AttributeEnd
)";
const char* const kCorners = "\"point3 portal\" [ -1 1 0  2 1 0  2 3 0  -1 3 0 ] ";
const std::vector<std::string> kEveryMix = {"bsdf:4",
                                            "bsdf:1+sa:2",
                                            "sa:3",
                                            "line-sa@u:2",
                                            "line-sa@v:2",
                                            "bsdf:1+line-sa@v:1",
                                            "sa:1+line-sa@u:1/power",
                                            "line-sa@u:1+line-sa@v:1",
                                            "line-sa@u:1+line-sa@v:1/average",
                                            "bsdf:1+line-sa@u:1/free"};

class PortalPictures : public testing::Test {
 protected:
  PortalPictures()
      : folder_(fs::path(testing::TempDir()) /
                (std::string("penumbra-portal-") +
                 testing::UnitTest::GetInstance()->current_test_info()->name())) {
    fs::create_directories(folder_);
  }
  ~PortalPictures() override { fs::remove_all(folder_); }
  void write_map(int width, int height, float sun) const {
    const int sun_at = width * height / 3 + 2;
    test::write_sky_map(folder_ / "map.exr", width, height, {{sun_at % width, sun_at / width, sun}});
  }
  ScenePtr scene(const std::string& light, const std::string& more = "",
                 const std::string& start = "") const {
    std::ofstream(folder_ / "scene.pbrt")
        << "LookAt 2.5 3 9  0 1 1  0 1 0\nCamera \"perspective\" \"float fov\" 40\n"
        << start << "WorldBegin\n"
        << light << kRoom << more;
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

TEST_F(PortalPictures, AConstantSky) {
  test::expect_agreement(scene(std::string("LightSource \"infinite\" \"rgb L\" [ 0.5 0.7 1 ] ") + kCorners),
                         kEveryMix, how());
}

TEST_F(PortalPictures, Maps) {
  for (const char* name : {"mapname", "filename"}) {
    write_map(name[0] == 'm' ? 32 : 16, 16, 4);
    test::expect_agreement(scene(std::string("AttributeBegin Rotate 37 1 2 3 Scale -1 1 1\n"
                                             "LightSource \"infinite\" \"string ") +
                                 name + "\" \"map.exr\" " + kCorners + " AttributeEnd\n"),
                           kEveryMix, how());
  }
}

/// Fog, a lamp, and a sky all around beside the one behind the window.
TEST_F(PortalPictures, AmongOthers) {
  test::AgreementSpec less = how();
  less.width = 32;
  less.height = 24;
  const std::string sky = std::string("LightSource \"infinite\" \"rgb L\" [ 0.5 0.7 1 ] ") + kCorners + "\n";
  test::expect_agreement(scene(sky + "LightSource \"infinite\" \"rgb L\" [ 0.1 0.02 0 ]\n",
                               "AttributeBegin AreaLightSource \"diffuse\" \"rgb L\" [ 3 2 1 ]\n"
                               "Shape \"quad\" \"point o\" [ -1 3.5 3 ] \"vector u\" [ 2 0 0 ] \"vector v\" "
                               "[ 0 0 1 ] AttributeEnd\n"),
                         {"bsdf:2+sa:1", "sa:2", "line-sa@u:1", "bsdf:1+line-sa@v:1", "sa:1/balance"}, less);
  test::expect_agreement(
      scene(sky,
            "AttributeBegin MediumInterface \"fog\" \"\" Material \"interface\"\n"
            "Translate 0 2 2 Shape \"sphere\" \"float radius\" 1.5 AttributeEnd\n",
            "MakeNamedMedium \"fog\" \"string type\" \"homogeneous\" \"rgb sigma_a\" [ 0.1 0.1 0.1 ] \"rgb "
            "sigma_s\" [ 0.3 0.3 0.3 ]\n"),
      {"bsdf:1+sa:1", "sa:2", "line-sa@u:1", "bsdf:1+line-sa@u:1"}, less);
}

/// A constant sky behind a window lights a room as a lamp in the window does, where nothing is outside.
TEST_F(PortalPictures, AWindowIsALamp) {
  const auto picture = [&](const std::string& light) {
    std::ofstream(folder_ / "scene.pbrt")
        << "LookAt 0 6 6  0.3 0 2.5  0 1 0\nCamera \"perspective\" \"float fov\" 40\nWorldBegin\n"
        << light << R"(Material "matte" "rgb Kd" [ 0.7 0.7 0.7 ]
Shape "trianglemesh" "integer indices" [ 0 1 2 0 2 3 ] "point P" [ -3 0 0  -3 0 6  3 0 6  3 0 0 ]
AttributeBegin Translate 0 0.8 2 Shape "sphere" "float radius" 0.6 AttributeEnd
)";
    const ScenePtr made = test::load(folder_ / "scene.pbrt");
    JobSpec job = test::job(32, 32, {"sa:2"}, 64);
    return blocks(test::render(*made, job).images[0], job.crop);
  };
  const auto window = picture(std::string("LightSource \"infinite\" \"rgb L\" [ 1 2 3 ] ") + kCorners);
  const auto lamp = picture(
      "AttributeBegin AreaLightSource \"diffuse\" \"rgb L\" [ 1 2 3 ]\nShape \"quad\" \"point o\" [ -1 1 0 ] "
      "\"vector u\" [ 3 0 0 ] \"vector v\" [ 0 2 0 ] AttributeEnd\n");
  std::vector<double> a, b, variance;
  for (size_t k = 0; k < lamp.size(); ++k) {
    EXPECT_GT(lamp[k].mean[0], 0);
    a.push_back(window[k].mean[0]);
    b.push_back(lamp[k].mean[0]);
    variance.push_back(window[k].variance[0] + lamp[k].variance[0]);
  }
  EXPECT_TRUE(z_test(a, b, variance, 0.001).passes());
}

}  // namespace
}  // namespace penumbra
