// Real scenes: the visible fraction of chords on their lights against thousands of rays each. Reads
// PENUMBRA_SCENES_DIR; without it the tests are skipped.
#include <gtest/gtest.h>

#include <cstdlib>

#include "proto/status.h"
#include "tests/bench/geometry/bench_scene.h"
#include "tests/bench/geometry/exact_scene.h"

namespace penumbra::bench {
namespace {

class SceneRays : public ::testing::TestWithParam<const char*> {};

TEST_P(SceneRays, VisibleFractionMatchesRays) {
  const char* folder = std::getenv("PENUMBRA_SCENES_DIR");
  if (folder == nullptr) GTEST_SKIP() << "PENUMBRA_SCENES_DIR is not set";
  const auto scene = load_bench_scene(std::string(folder) + "/" + GetParam());
  ASSERT_TRUE(scene.ok()) << message_of(scene.status());
  const auto geometry = Geometry::build(scene->inputs(), scene->objects, scene->instances, 2);
  ASSERT_TRUE(geometry.ok());
  constexpr int kRays = 4096;
  QueryCounters counters;
  std::vector<IntervalSet> visible;
  double sum = 0;
  int beyond = 0;
  const auto points = tile_coherent_points(*geometry, *scene, 2000, 1, 3);
  ASSERT_EQ(points.size(), 2000u);
  for (const ShadingPoint& point : points) {
    const LineQuery& query = point.lines[0];
    geometry->visible({&query, 1}, visible, counters);
    int lit = 0, changes = 0;
    bool before = true;
    for (int k = 0; k < kRays; ++k) {
      const float v = (static_cast<float>(k) + 0.5f) / kRays;
      // Short of the light: a ray has no other way to spare it.
      const Vec3f y = query.x + (query.a + (query.b - query.a) * v - query.x) * 0.9999f;
      const bool now = !geometry->occluded(query.x, y, counters);
      lit += now;
      changes += k > 0 && now != before;
      before = now;
    }
    const double difference = std::abs(visible[0].length() - static_cast<double>(lit) / kRays);
    sum += difference;
    beyond += difference > (changes + 1) * 0.5 / kRays + 1e-3;
  }
  EXPECT_LT(sum / 2000, 2e-4);
  // Rays that graze an edge, or pass between two, may differ on a few chords.
  EXPECT_LE(beyond, 4);
  std::printf("%s: mean difference %.2e, %d chords beyond the sampling tolerance\n", GetParam(), sum / 2000,
              beyond);
}

/// A sample of what `bench_line_exact` does for 1e5 chords.
TEST(SceneExact, EveryTriangleOfTheCornellBox) {
  const char* folder = std::getenv("PENUMBRA_SCENES_DIR");
  if (folder == nullptr) GTEST_SKIP() << "PENUMBRA_SCENES_DIR is not set";
  const auto scene = load_bench_scene(std::string(folder) + "/cornell-box/cornell-box.pbrt");
  ASSERT_TRUE(scene.ok()) << message_of(scene.status());
  const auto geometry = Geometry::build(scene->inputs(), {}, {}, 1);
  ASSERT_TRUE(geometry.ok());
  const Exactness e = compare_with_all(*geometry, *scene, 5000, 4);
  EXPECT_EQ(e.chords, 5000u);
  EXPECT_EQ(e.wrong, 0u);
  EXPECT_LT(e.doubtful,
            e.chords / 2);  // its chords lie along the walls' directions, and so in planes of vertices
  EXPECT_GT(e.partly, e.chords / 100);
}

INSTANTIATE_TEST_SUITE_P(Scenes, SceneRays,
                         ::testing::Values("cornell-box/cornell-box.pbrt", "kitchen/kitchen-play.pbrt"));

}  // namespace
}  // namespace penumbra::bench
