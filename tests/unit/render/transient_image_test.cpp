// Pictures in bins of path length: nothing about the picture changes, and the bins make it up.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/render.h"

namespace penumbra {
namespace {

const char* const kScene = R"(LookAt 0 3 6  0 0.5 0  0 1 0
Camera "perspective" "float fov" 40
WorldBegin
LightSource "point" "point from" [ 2 3 1 ] "rgb I" [ 1 2 3 ]
AttributeBegin
AreaLightSource "diffuse" "rgb L" [ 5 5 5 ]
Shape "quad" "point o" [ -0.7 2.2 -0.5 ] "vector u" [ 1.4 0 0 ] "vector v" [ 0 0 0.9 ]
AttributeEnd
AttributeBegin
AreaLightSource "diffuse" "rgb L" [ 1 1 0 ]
Translate -2 0 0 Shape "sphere" "float radius" 0.2
AttributeEnd
Material "plastic"
Shape "sphere" "float radius" 0.7
Material "mirror"
Shape "trianglemesh" "integer indices" [ 0 1 2 ] "point P" [ 1 -0.7 -1  2 -0.7 -1  1.5 2 -1 ]
Material "matte"
Shape "trianglemesh" "integer indices" [ 0 1 2 0 2 3 ] "point P" [ -4 -0.7 -4  -4 -0.7 4  4 -0.7 4  4 -0.7 -4 ]
)";

JobSpec small_job(const std::vector<std::string>& mixes, const std::optional<Transient>& transient) {
  JobSpec spec = test::job(32, 24, mixes, 8);
  spec.max_depth = 4;
  spec.tile = 16;
  spec.transient = transient;
  return spec;
}

/// Σ of the bins at a value of the picture.
double sum_of(const std::vector<FilmImage>& bins, size_t value) {
  double sum = 0;
  for (const FilmImage& bin : bins) sum += double(bin.rgb[value]);
  return sum;
}

const std::vector<std::string> kMixes = {"bsdf:1+sa:2",
                                         "area:2",
                                         "bsdf:1+visible-area:1",
                                         "bsdf:1+line-sa@u:2",
                                         "line-sa@v:1+line-area@30:1/average",
                                         "line-analytic@0:2",
                                         "bsdf:1+line-sa@u:1/smooth=auto",
                                         "bsdf:1+line-sa@v:1/free"};

TEST(TransientImage, ThePictureIsWhatItIsWithout) {
  const ScenePtr scene = test::load_text(kScene);
  ASSERT_TRUE(scene);
  const test::Rendered plain = test::render(*scene, small_job(kMixes, {}), 4);
  const test::Rendered binned = test::render(*scene, small_job(kMixes, Transient{3, 12, 20}), 4);
  for (size_t m = 0; m < kMixes.size(); ++m) {
    EXPECT_EQ(plain.images[m].rgb, binned.images[m].rgb) << kMixes[m];
    EXPECT_EQ(plain.images[m].variance, binned.images[m].variance) << kMixes[m];
    EXPECT_EQ(binned.bins[m].size(), 20u);
    EXPECT_TRUE(plain.bins[m].empty());
  }
}

/// One bin that holds everything has, for lines too, the very samples of the picture.
TEST(TransientImage, OneBinForEverythingIsThePicture) {
  const ScenePtr scene = test::load_text(kScene);
  ASSERT_TRUE(scene);
  const test::Rendered r = test::render(*scene, small_job(kMixes, Transient{0, 1000, 1}), 4);
  for (size_t m = 0; m < kMixes.size(); ++m)
    for (size_t i = 0; i < r.images[m].rgb.size(); ++i) {
      const float is = r.images[m].rgb[i];
      // The picture's samples are summed in single precision, a few dozen of them.
      ASSERT_NEAR(sum_of(r.bins[m], i), is, 2e-6 * std::abs(is)) << kMixes[m] << ", value " << i;
      // Group means that are off by so much leave a variance that is off by twice its root times that.
      const double variance = r.images[m].variance[i];
      ASSERT_NEAR(r.bins[m][0].variance[i], variance,
                  1e-5 * variance + 2 * std::sqrt(variance) * 2e-6 * std::abs(is));
    }
}

TEST(TransientImage, BinsOfPointsSumToThePicture) {
  const ScenePtr scene = test::load_text(kScene);
  ASSERT_TRUE(scene);
  const std::vector<std::string> mixes = {"bsdf:1+sa:2", "area:2", "bsdf:1+visible-area:1"};
  const test::Rendered r = test::render(*scene, small_job(mixes, Transient{0, 1000, 400}), 4);
  for (size_t m = 0; m < mixes.size(); ++m)
    for (size_t i = 0; i < r.images[m].rgb.size(); ++i) {
      const float is = r.images[m].rgb[i];
      ASSERT_NEAR(sum_of(r.bins[m], i), is, 3e-6 * std::abs(is)) << mixes[m] << ", value " << i;
    }
}

TEST(TransientImage, NothingArrivesBeforeTheShortestPath) {
  const ScenePtr scene = test::load_text(kScene);
  ASSERT_TRUE(scene);
  // The camera is 4 away from everything.
  const test::Rendered r = test::render(*scene, small_job(kMixes, Transient{0, 4, 8}), 4);
  for (const std::vector<FilmImage>& bins : r.bins)
    for (const FilmImage& bin : bins)
      for (const float v : bin.rgb) ASSERT_EQ(v, 0);
}

/// A small patch 10 below the camera, lit by a tiny light 20 above it: 30 and hardly more.
TEST(TransientImage, APatchLitByATinyLightArrivesInOneBin) {
  const ScenePtr scene = test::load_text(R"(LookAt 0 10 0  0 0 0  0 0 1
Camera "perspective" "float fov" 1
WorldBegin
AttributeBegin AreaLightSource "diffuse" "rgb L" [ 1e6 1e6 1e6 ]
Shape "quad" "point o" [ 0.5 20 0 ] "vector u" [ 0.01 0 0 ] "vector v" [ 0 0 0.01 ] AttributeEnd
Material "matte"
Shape "trianglemesh" "integer indices" [ 0 1 2 0 2 3 ] "point P" [ -1 0 -1  -1 0 1  1 0 1  1 0 -1 ]
)");
  ASSERT_TRUE(scene);
  // Camera to floor 10 to 10.0008, floor to light 20.0062 ± 0.006.
  const std::vector<std::string> mixes = {"sa:1", "line-sa@u:1", "line-analytic@0:1"};
  const test::Rendered r = test::render(*scene, small_job(mixes, Transient{20, 40, 20}), 4);
  for (size_t m = 0; m < mixes.size(); ++m)
    for (size_t i = 0; i < r.images[m].rgb.size(); ++i) {
      ASSERT_GT(r.images[m].rgb[i], 0);
      for (size_t b = 0; b < 20; ++b) {
        if (b != 10) {
          ASSERT_EQ(r.bins[m][b].rgb[i], 0) << mixes[m] << ", bin " << b;
        }
      }
      ASSERT_NEAR(r.bins[m][10].rgb[i], r.images[m].rgb[i], 1e-5 * r.images[m].rgb[i]);
    }
}

TEST(TransientImage, LightAlongAMirrorComesByItsWholePath) {
  // Straight down, a mirror at 45°, and a wall that shines 3 away from it: 5 + 3.
  const ScenePtr scene = test::load_text(R"(LookAt 0 5 0  0 0 0  0 0 1
Camera "perspective" "float fov" 1
WorldBegin
Material "mirror"
Shape "trianglemesh" "integer indices" [ 0 1 2 0 2 3 ] "point P" [ -1 -1 -1  -1 -1 1  1 1 1  1 1 -1 ]
AttributeBegin AreaLightSource "diffuse" "rgb L" [ 2 2 2 ] "bool twosided" "true"
Shape "quad" "point o" [ -3 -2 -2 ] "vector u" [ 0 4 0 ] "vector v" [ 0 0 4 ] AttributeEnd
)");
  ASSERT_TRUE(scene);
  const test::Rendered r = test::render(*scene, small_job({"sa:1"}, Transient{7.5, 8.5, 2}), 4);
  // Lengths lie around 8: both bins together have all of it, and nothing else has any.
  for (size_t i = 0; i < r.images[0].rgb.size(); ++i) {
    ASSERT_GT(r.images[0].rgb[i], 0);
    ASSERT_NEAR(sum_of(r.bins[0], i), r.images[0].rgb[i], 1e-5 * r.images[0].rgb[i]);
  }
}

}  // namespace
}  // namespace penumbra
