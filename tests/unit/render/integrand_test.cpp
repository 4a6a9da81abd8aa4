#include "worker/render/integrand.h"

#include <gtest/gtest.h>

#include <atomic>

#include "tests/support/render.h"

namespace penumbra {
namespace {

// A box between floor and light hides a part of the light from the pixel that is looked at.
const char* const kScene = R"(LookAt 0 4 5  0 0 0  0 1 0
Camera "perspective" "float fov" 40
WorldBegin
AttributeBegin
AreaLightSource "diffuse" "rgb L" [ 5 5 5 ]
Shape "quad" "point o" [ -1 0.5 -2 ] "vector u" [ 2 0 0 ] "vector v" [ 0 1.5 0 ]
AttributeEnd
Material "matte" "rgb Kd" [ 0.5 0.5 0.5 ]
Shape "trianglemesh" "integer indices" [ 0 1 2 0 2 3 ] "point P" [ -4 0 -4  -4 0 4  4 0 4  4 0 -4 ]
Shape "trianglemesh" "integer indices" [ 0 1 2 0 2 3 ] "point P" [ 0 0 -1  0 0.6 -1  2 0.6 -1  2 0 -1 ]
)";
constexpr int kGrid = 64;

JobSpec integrand_job(const std::vector<std::string>& mixes, std::vector<int> slots, int light = 0) {
  JobSpec job = test::job(kGrid, kGrid, mixes, 1);
  job.probe = Probe{Probe::Kind::kIntegrand, 16, 16, 8, 9, light, std::move(slots)};
  return job;
}

std::vector<TilePixels> draw(const Scene& scene, const JobSpec& job) {
  const std::atomic<bool> cancel = false;
  TileTask task;
  task.tile = job.crop;
  task.passes.assign(job.mixes.size(), {0, 1});
  return render_tile(scene, job, task, cancel).pixels.mixes;
}

double mean(const TilePixels& pixels) {
  double sum = 0;
  for (const float v : pixels.mean) sum += v;
  return sum / static_cast<double>(pixels.mean.size());
}

TEST(Integrand, OfUniformPointsHasThePixelsRadianceAsItsMean) {
  // Points uniform on the light: the mean of f/p over the light is what the estimator estimates.
  const ScenePtr scene = test::load_text(kScene);
  ASSERT_TRUE(scene);
  JobSpec picture = test::job(16, 16, {"sa:64"}, 64);
  picture.probe = Probe{};
  const FilmImage image = test::render(*scene, picture).images[0];
  const double radiance = image.rgb[3 * image.index(8, 9)];
  ASSERT_GT(radiance, 0);
  EXPECT_NEAR(mean(draw(*scene, integrand_job({"area:1"}, {0}))[0]) / radiance, 1, 0.01);
}

TEST(Integrand, OfSolidAnglePointsIsFlatterAndBlackWhereHidden) {
  const ScenePtr scene = test::load_text(kScene);
  ASSERT_TRUE(scene);
  const auto pixels = draw(*scene, integrand_job({"sa:1", "line-sa@u:1", "line-sa@u:1+sa:1"}, {0, 0, 1}));
  size_t hidden = 0;
  for (size_t p = 0; p < pixels[0].mean.size(); p += 3) {
    hidden += pixels[0].mean[p] == 0;
    EXPECT_EQ(pixels[0].mean[p] == 0, pixels[1].mean[p] == 0) << "lines see what points see, pixel " << p / 3;
    // The balance heuristic: f / Σ n p, below what each strategy alone would give.
    EXPECT_LE(pixels[2].mean[p], pixels[0].mean[p] * 1.0001f);
  }
  EXPECT_GT(hidden, 100u);
  EXPECT_LT(hidden, pixels[0].mean.size() / 3 - 100);
}

TEST(Integrand, OfALightThatIsNotThereIsBlack) {
  const ScenePtr scene = test::load_text(kScene);
  ASSERT_TRUE(scene);
  EXPECT_EQ(mean(draw(*scene, integrand_job({"sa:1"}, {0}, 7))[0]), 0);
  EXPECT_EQ(mean(draw(*scene, integrand_job({"sa:1"}, {3}))[0]), 0) << "a slot that the mix does not have";
}

}  // namespace
}  // namespace penumbra
