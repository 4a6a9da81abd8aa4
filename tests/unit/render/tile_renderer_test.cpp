#include <gtest/gtest.h>

#include <atomic>

#include "tests/support/render.h"
#include "worker/render/calibration.h"
#include "worker/render/renderer.h"

namespace penumbra {
namespace {

const char* const kScene = R"(LookAt 0 3 6  0 0.5 0  0 1 0
Camera "perspective" "float fov" 40
WorldBegin
AttributeBegin
AreaLightSource "diffuse" "rgb L" [ 5 5 5 ]
Shape "quad" "point o" [ -0.7 2.2 -0.5 ] "vector u" [ 1.4 0 0 ] "vector v" [ 0 0 0.9 ]
AttributeEnd
Material "plastic"
Shape "sphere" "float radius" 0.7
Shape "trianglemesh" "integer indices" [ 0 1 2 0 2 3 ] "point P" [ -4 -0.7 -4  -4 -0.7 4  4 -0.7 4  4 -0.7 -4 ]
)";

TileTask task(const JobSpec& spec, PassRange first, PassRange second) {
  TileTask t;
  t.tile = spec.crop;
  t.passes = {first, second};
  return t;
}

TEST(TileRenderer, TheOrderOfSlicesIsNoPartOfTheImage) {
  const ScenePtr scene = test::load_text(kScene);
  ASSERT_TRUE(scene);
  const JobSpec spec = test::job(16, 12, {"bsdf:1+line-sa@u:1", "sa:2"}, 9);
  const std::atomic<bool> cancel = false;
  TileTask a = task(spec, {0, 9}, {0, 9}), b = a;
  a.shuffle = 1;
  b.shuffle = 99;
  const TaskOutcome x = render_tile(*scene, spec, a, cancel), y = render_tile(*scene, spec, b, cancel);
  for (int m = 0; m < 2; ++m) {
    EXPECT_EQ(x.pixels.mixes[m].mean, y.pixels.mixes[m].mean);
    EXPECT_EQ(x.pixels.mixes[m].m2, y.pixels.mixes[m].m2);
    EXPECT_GT(x.pixels.mixes[m].mean[3 * 16 * 6 + 24], 0) << "the picture is black";
  }
}

TEST(TileRenderer, MixesAndPassesHaveRandomNumbersOfTheirOwn) {
  const ScenePtr scene = test::load_text(kScene);
  ASSERT_TRUE(scene);
  const JobSpec spec = test::job(16, 12, {"sa:1", "sa:1"}, 1);
  const std::atomic<bool> cancel = false;
  const TaskOutcome first = render_tile(*scene, spec, task(spec, {0, 1}, {0, 1}), cancel);
  const TaskOutcome second = render_tile(*scene, spec, task(spec, {1, 2}, {1, 2}), cancel);
  EXPECT_NE(first.pixels.mixes[0].mean, first.pixels.mixes[1].mean);
  EXPECT_NE(first.pixels.mixes[0].mean, second.pixels.mixes[0].mean);
}

TEST(TileRenderer, RepeatedPassesOfThePilotAreTimedAndLeaveNoTrace) {
  const ScenePtr scene = test::load_text(kScene);
  ASSERT_TRUE(scene);
  const JobSpec spec = test::job(16, 12, {"bsdf:1+line-sa@u:1", "sa:2"}, 9);
  const std::atomic<bool> cancel = false;
  const TileTask plain = task(spec, {4, 13}, {0, 9});
  TileTask repeats = plain;
  repeats.repilot = {{2, 5}, {0, 0}};
  const TaskOutcome x = render_tile(*scene, spec, plain, cancel),
                    y = render_tile(*scene, spec, repeats, cancel);
  for (size_t m = 0; m < 2; ++m) {
    EXPECT_EQ(x.pixels.mixes[m].mean, y.pixels.mixes[m].mean);
    EXPECT_EQ(x.pixels.mixes[m].m2, y.pixels.mixes[m].m2);
    EXPECT_EQ(y.costs[m].passes, 9);
    EXPECT_EQ(x.costs[m].rays, y.costs[m].rays);
    EXPECT_EQ(x.costs[m].repilot_passes, 0);
  }
  EXPECT_EQ(y.costs[0].repilot_passes, 3);
  EXPECT_GT(y.costs[0].repilot_seconds, 0);
  EXPECT_EQ(y.costs[1].repilot_passes, 0);
  EXPECT_EQ(y.costs[1].repilot_seconds, 0);
}

TEST(TileRenderer, APilotReportsCostsAndNoPixels) {
  const ScenePtr scene = test::load_text(kScene);
  ASSERT_TRUE(scene);
  const JobSpec spec = test::job(16, 12, {"sa:1", "bsdf:1"}, 1);
  const std::atomic<bool> cancel = false;
  TileTask pilot = task(spec, {0, 1000}, {0, 1000});
  pilot.kind = TaskKind::kPilot;
  pilot.pilot_seconds = 0.01;
  const TaskOutcome outcome = render_tile(*scene, spec, pilot, cancel);
  EXPECT_TRUE(outcome.pixels.mixes.empty());
  for (const MixCost& cost : outcome.costs) {
    EXPECT_GE(cost.passes, 1);
    EXPECT_LT(cost.passes, 1000);
    EXPECT_GT(cost.cpu_seconds, 0);
    EXPECT_GT(cost.rays, 0u);
  }
}

TEST(TileRenderer, AProbeLooksAtPixelCentres) {
  // A light without extent: nothing but the camera samples varies, at the sphere's outline and over it.
  const ScenePtr scene = test::load_text(R"(LookAt 0 3 6  0 0.5 0  0 1 0
Camera "perspective" "float fov" 40
WorldBegin
LightSource "distant" "point from" [ 1 2 3 ] "point to" [ 0 0 0 ]
Shape "sphere" "float radius" 0.7
)");
  ASSERT_TRUE(scene);
  JobSpec spec = test::job(16, 12, {"sa:1", "sa:1"}, 64);
  const std::atomic<bool> cancel = false;
  const auto spread = [&] {
    const TaskOutcome outcome = render_tile(*scene, spec, task(spec, {0, 64}, {0, 0}), cancel);
    double sum = 0;
    for (const float m2 : outcome.pixels.mixes[0].m2) sum += m2;
    return sum;
  };
  EXPECT_GT(spread(), 1);
  spec.probe = Probe{};
  EXPECT_EQ(spread(), 0);
}

TEST(TileRenderer, TheCalibrationLoopIsTimedInRunsOnly) {
  const ScenePtr scene = test::load_text(kScene);
  ASSERT_TRUE(scene);
  const JobSpec spec = test::job(16, 12, {"sa:1", "bsdf:1"}, 1);
  const std::atomic<bool> cancel = false;
  Calibration total;
  for (const MixCost& cost : render_tile(*scene, spec, task(spec, {0, 8}, {0, 8}), cancel).costs)
    total += cost.calibration;
  EXPECT_GE(total.units, 1u);
  EXPECT_GT(total.seconds, 1e-6);
  EXPECT_LT(total.seconds / static_cast<double>(total.units), 0.01);
  TileTask pilot = task(spec, {0, 8}, {0, 8});
  pilot.kind = TaskKind::kPilot;
  for (const MixCost& cost : render_tile(*scene, spec, pilot, cancel).costs)
    EXPECT_EQ(cost.calibration, Calibration{});
}

TEST(Calibration, AUnitIsAlwaysTheSameWork) {
  EXPECT_EQ(calibration_unit(), calibration_unit());
  EXPECT_GT(calibration_unit(), 1);
}

TEST(TileRenderer, AutoIsWhatItsTaskSays) {
  const ScenePtr scene = test::load_text(kScene);
  ASSERT_TRUE(scene);
  const std::atomic<bool> cancel = false;
  const JobSpec fixed = test::job(16, 12, {"sa:1", "bsdf:1+line-sa@u:1"}, 8);
  const JobSpec automatic = test::job(16, 12, {"sa:1", "auto"}, 8);
  TileTask a = task(fixed, {0, 8}, {0, 8}), b = a;
  a.group = 4;
  b.group = 1;
  b.chosen = {{1, fixed.mixes[1], 4}};
  const TaskOutcome x = render_tile(*scene, fixed, a, cancel), y = render_tile(*scene, automatic, b, cancel);
  EXPECT_EQ(x.pixels.mixes[1].mean, y.pixels.mixes[1].mean) << "another mix, or another group than chosen";
  EXPECT_EQ(y.pixels.mixes[1].groups, 2);
  EXPECT_EQ(y.costs.size(), 2u);
}

TEST(TileRenderer, BlocksOfAutoSitOutPasses) {
  const ScenePtr scene = test::load_text(kScene);
  ASSERT_TRUE(scene);
  const std::atomic<bool> cancel = false;
  const JobSpec spec = test::job(16, 12, {"sa:1", "auto"}, 8);
  TileTask all = task(spec, {0, 0}, {0, 8}), some = all, fewer = task(spec, {0, 0}, {0, 4});
  all.chosen = fewer.chosen = {{1, *parse_mix("bsdf:1+line-sa@u:1"), 2}};
  some.chosen = {{1, *parse_mix("bsdf:1+line-sa@u:1"), 2, {255, 128, 255, 255}}};  // half of 4 groups of 2
  const TilePixels x = render_tile(*scene, spec, all, cancel).pixels.mixes[1];
  const TilePixels y = render_tile(*scene, spec, some, cancel).pixels.mixes[1];
  const TilePixels z = render_tile(*scene, spec, fewer, cancel).pixels.mixes[1];
  EXPECT_TRUE(x.block_passes.empty());
  EXPECT_EQ(y.block_passes, (std::vector<int32_t>{8, 4, 8, 8}));
  EXPECT_EQ(y.block_groups, (std::vector<int32_t>{4, 2, 4, 4}));
  for (size_t i = 0; i < y.mean.size(); ++i) {
    const bool second = i / 3 / 16 < 8 && i / 3 % 16 >= 8;
    EXPECT_EQ(y.mean[i], second ? z.mean[i] : x.mean[i]) << i;
    EXPECT_EQ(y.m2[i], second ? z.m2[i] : x.m2[i]) << i;
  }
  // In ranges: the same samples.
  TileTask begin = some, end = some;
  begin.passes[1] = {0, 4};
  end.passes[1] = {4, 8};
  const TilePixels b = render_tile(*scene, spec, begin, cancel).pixels.mixes[1];
  const TilePixels e = render_tile(*scene, spec, end, cancel).pixels.mixes[1];
  const size_t pixel = 3 * (2 * 16 + 12);
  const double n = double(b.block_passes.empty() ? b.passes : b.block_passes[1]);
  EXPECT_EQ(e.block_passes[1] + n, 4);
  EXPECT_NEAR((n * double(b.mean[pixel]) + e.block_passes[1] * double(e.mean[pixel])) / 4,
              double(y.mean[pixel]), 1e-5);
}

TEST(TileRenderer, WholePassesOfAPilotTellOfBlocks) {
  const ScenePtr scene = test::load_text(kScene);
  ASSERT_TRUE(scene);
  const std::atomic<bool> cancel = false;
  const JobSpec spec = test::job(16, 12, {"auto"}, 8);
  TileTask pilot;
  pilot.kind = TaskKind::kPilot;
  pilot.tile = spec.crop;
  pilot.passes = {{0, 3}};
  pilot.pilot_blocks = 5;
  for (const char* text : {"sa:4", "bsdf:1", "bsdf:2+sa:2"}) pilot.chosen.push_back({0, *parse_mix(text), 1});
  const MixCost cost = render_tile(*scene, spec, pilot, cancel).costs[0];
  EXPECT_EQ(cost.passes, 3);
  EXPECT_EQ(cost.candidate, 2) << "neither the wild one nor the unbounded one";
  ASSERT_EQ(cost.blocks.size(), 4u);
  double seconds = 0;
  for (const BlockCost& block : cost.blocks) {
    EXPECT_GT(block.relative_deviation, 0);
    seconds += double(block.cpu_seconds);
  }
  EXPECT_NEAR(seconds * 3, cost.cpu_seconds, 1e-3 * cost.cpu_seconds);
  // No time for two passes: some tiles make one, for its cost.
  pilot.pilot_seconds = 1e-9;
  EXPECT_EQ(render_tile(*scene, spec, pilot, cancel).costs[0].passes, 1);
  EXPECT_TRUE(render_tile(*scene, spec, pilot, cancel).costs[0].blocks.empty());
  pilot.id = 1;
  EXPECT_EQ(render_tile(*scene, spec, pilot, cancel).costs[0].passes, 0);
}

/// A pilot of `auto` with these candidates on 5 blocks.
std::vector<MixCost> candidate_costs(const Scene& scene, const std::vector<const char*>& candidates,
                                     uint64_t shuffle) {
  const JobSpec spec = test::job(16, 12, {"auto"}, 8);
  TileTask pilot;
  pilot.kind = TaskKind::kPilot;
  pilot.tile = spec.crop;
  pilot.passes = {{0, 0}};
  pilot.shuffle = shuffle;
  pilot.pilot_blocks = 5;
  for (const char* text : candidates) pilot.chosen.push_back({0, *parse_mix(text), 1});
  const std::atomic<bool> cancel = false;
  TaskOutcome outcome = render_tile(scene, spec, pilot, cancel);
  EXPECT_EQ(outcome.costs.size(), 1 + candidates.size());
  return {outcome.costs.begin() + 1, outcome.costs.end()};
}

TEST(TileRenderer, CandidatesAreMeasuredOnTheSamePixels) {
  const ScenePtr scene = test::load_text(kScene);
  ASSERT_TRUE(scene);
  const auto costs = candidate_costs(*scene, {"sa:1", "sa:1", "sa:16", "line-sa@u:1", "bsdf:16"}, 1);
  for (const MixCost& cost : costs) {
    EXPECT_EQ(cost.pixels, 5 * 8);
    EXPECT_EQ(cost.passes, 4);
    EXPECT_GT(cost.cpu_seconds, 0);
    EXPECT_GT(cost.work, 0);
  }
  EXPECT_EQ(costs[0].relative_variance, costs[1].relative_variance) << "other random numbers";
  EXPECT_GT(costs[0].relative_variance, 2 * costs[2].relative_variance);
  EXPECT_GT(costs[4].work, 2 * costs[0].work);
  EXPECT_GT(costs[3].line_queries, 0u);
  // Whatever the order of rendering and the clock: what plans of pass counts are made from is the same.
  const auto again = candidate_costs(*scene, {"sa:1", "sa:1", "sa:16", "line-sa@u:1", "bsdf:16"}, 99);
  for (size_t k = 0; k < costs.size(); ++k) {
    EXPECT_EQ(costs[k].relative_variance, again[k].relative_variance);
    EXPECT_EQ(costs[k].work, again[k].work);
  }
}

TEST(TileRenderer, LinesAreNoCandidatesWhereNoLightServesThem) {
  std::string text = kScene;
  const size_t quad = text.find("Shape \"quad\"");
  text.replace(quad, text.find('\n', quad) - quad, "Translate 0 3 0 Shape \"sphere\" \"float radius\" 0.3");
  const ScenePtr scene = test::load_text(text.c_str());
  ASSERT_TRUE(scene);
  const auto costs = candidate_costs(*scene, {"bsdf:1+line-sa@v:1", "sa:1"}, 1);
  EXPECT_EQ(costs[0].pixels, 0);
  EXPECT_EQ(costs[1].pixels, 5 * 8);
}

TEST(TileRenderer, CancelLeavesBetweenPasses) {
  const ScenePtr scene = test::load_text(kScene);
  ASSERT_TRUE(scene);
  const JobSpec spec = test::job(16, 12, {"sa:1", "sa:1"}, 1);
  const std::atomic<bool> cancel = true;
  EXPECT_TRUE(render_tile(*scene, spec, task(spec, {0, 100}, {0, 100}), cancel).cancelled);
}

}  // namespace
}  // namespace penumbra
