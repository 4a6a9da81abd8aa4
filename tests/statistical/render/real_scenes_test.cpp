// Effects on scenes that others made: points against lines, and the lens against pbrt's own picture. They are
// read where they are (PENUMBRA_SCENES_DIR), and skipped visibly where they are not.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "film/exr.h"
#include "film/statistics.h"
#include "proto/status.h"
#include "tests/statistical/render/agreement.h"

namespace penumbra {
namespace {

struct Case {
  std::string effect, scene;
  std::vector<std::string> mixes;
  test::AgreementSpec how;
};

/// For the test's listing.
void PrintTo(const Case& c, std::ostream* out) {
  *out << c.scene;
}

test::AgreementSpec picture(int width, int height, int64_t passes) {
  test::AgreementSpec how;
  how.width = width;
  how.height = height;
  how.passes = passes;
  return how;
}

test::AgreementSpec binned(test::AgreementSpec how, const Transient& transient) {
  how.transient = transient;
  how.tile = 16;
  return how;
}

class RealScene : public testing::TestWithParam<Case> {};

TEST_P(RealScene, PointsAndLinesAgree) {
  const char* const folder = std::getenv("PENUMBRA_SCENES_DIR");
  if (!folder) GTEST_SKIP() << "PENUMBRA_SCENES_DIR is not set";
  const Case& c = GetParam();
  test::expect_agreement(test::load(std::string(folder) + "/" + c.scene), c.mixes, c.how);
}

INSTANTIATE_TEST_SUITE_P(Effects, RealScene,
                         testing::Values(Case{"lens",
                                              "figures-pbrt3/f7-19a.pbrt",
                                              {"bsdf:1+sa:1", "bsdf:1+sa:1/lens=line"},
                                              picture(48, 48, 16)},
                                         Case{"lens_and_glass",
                                              "pbrt3-features/cameras/depth-of-field.pbrt",
                                              {"bsdf:1+sa:1", "bsdf:1+sa:1/lens=line"},
                                              picture(80, 40, 32)},
                                         Case{"motion",
                                              "simple-pbrt3/anim-bluespheres.pbrt",
                                              {"bsdf:1+sa:1", "bsdf:1+sa:1/motion=line"},
                                              picture(80, 40, 32)},
                                         Case{"media",
                                              "fog-pbrt3/spotfog.pbrt",
                                              {"sa:1", "bsdf:1+sa:1", "sa:1/medium=line"},
                                              picture(70, 50, 64)},
                                         Case{"media_under_a_sky",
                                              "fog-pbrt3/f16-22a.pbrt",
                                              {"bsdf:1+sa:1", "bsdf:1+sa:1/medium=line"},
                                              picture(40, 40, 48)},
                                         Case{"environment",
                                              "figures-pbrt3/f10-1ac.pbrt",
                                              {"bsdf:1+sa:1", "sa:2", "line-sa@v:2", "bsdf:1+line-sa@u:1"},
                                              picture(40, 40, 24)},
                                         Case{"curves",
                                              "figures-pbrt3/f3-18.pbrt",
                                              {"bsdf:1+sa:1", "bsdf:1+line-sa@v:1"},
                                              picture(80, 60, 32)},
                                         Case{"transient",
                                              "cornell-box/cornell-box.pbrt",
                                              {"bsdf:1+sa:1", "line-sa@u:1", "line-sa@v:1"},
                                              binned(picture(32, 32, 64), {6.5, 10.5, 8})}),
                         [](const auto& each) { return each.param.effect; });

/// pbrt's picture has 1,024 samples a pixel and no variances; those of ours stand for them, scaled by how
/// many more samples it has (its own are stratified, so that its errors are smaller if anything). It is kept
/// in half floats: 2^-11 of a pixel at most, far less of a block.
TEST(RealLens, PbrtsPictureIsOurs) {
  const char* const folder = std::getenv("PENUMBRA_SCENES_DIR");
  if (!folder) GTEST_SKIP() << "PENUMBRA_SCENES_DIR is not set";
  const std::string root = std::string(folder) + "/figures-pbrt3/";
  if (!std::filesystem::exists(root + "f7-19a.pbrt")) GTEST_SKIP() << "no " << root;
  const auto theirs = read_exr(root + "reference/f7-19a.exr");
  ASSERT_TRUE(theirs.ok()) << message_of(theirs.status());
  const ScenePtr scene = test::load(root + "f7-19a.pbrt");
  ASSERT_TRUE(scene);
  constexpr int64_t kPasses = 24;
  constexpr double kTheirPasses = 1024;
  const std::vector<std::string> mixes = {"bsdf:1+sa:1", "bsdf:1+sa:1/lens=line"};
  const test::Rendered ours = test::render(*scene, test::job(64, 64, mixes, kPasses));
  const PixelRect whole{0, 0, 64, 64};
  const std::vector<Block> reference = blocks(*theirs, whole);
  const std::vector<Block> points = blocks(ours.images[0], whole);
  for (size_t m = 0; m < mixes.size(); ++m) {
    const std::vector<Block> mine = blocks(ours.images[m], whole);
    std::vector<double> a, b, variance;
    for (size_t k = 0; k < mine.size(); ++k)
      for (int c = 0; c < 3; ++c) {
        a.push_back(mine[k].mean[c]);
        b.push_back(reference[k].mean[c]);
        variance.push_back(mine[k].variance[c] + points[k].variance[c] * double(kPasses) / kTheirPasses);
      }
    const ZTest z = z_test(a, b, variance, 0.001, 0x1p-13);
    EXPECT_TRUE(z.passes()) << mixes[m] << ": worst |z| " << z.largest << " (limit " << z.threshold
                            << "), block " << z.worst / 3 << ": " << a[size_t(z.worst)] << " and "
                            << b[size_t(z.worst)];
  }
}

}  // namespace
}  // namespace penumbra
