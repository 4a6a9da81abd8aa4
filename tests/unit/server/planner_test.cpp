#include "server/planner.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

namespace penumbra {
namespace {

JobSpec spec_of(int width, int height, std::vector<const char*> mixes, Budget budget) {
  JobSpec spec;
  spec.bundle = Digest(64, 'a');
  for (const char* mix : mixes) spec.mixes.push_back(*parse_mix(mix));
  spec.budget = budget;
  spec.width = width;
  spec.height = height;
  spec.crop = {0, 0, width, height};
  return spec;
}

TEST(Planner, TilesCoverTheCropOnce) {
  JobSpec spec = spec_of(200, 150, {"bsdf"}, SppBudget{1});
  spec.crop = {3, 5, 190, 149};
  spec.tile = 32;
  std::vector<int> hits(200 * 150, 0);
  for (const PixelRect& tile : tiles_of(spec)) {
    EXPECT_LE(tile.width(), 32);
    EXPECT_LE(tile.height(), 32);
    for (int y = tile.y0; y < tile.y1; ++y)
      for (int x = tile.x0; x < tile.x1; ++x) ++hits[y * 200 + x];
  }
  for (int y = 0; y < 150; ++y)
    for (int x = 0; x < 200; ++x)
      EXPECT_EQ(hits[y * 200 + x], x >= 3 && x < 190 && y >= 5 && y < 149 ? 1 : 0);
}

TEST(Planner, TilesAreCountedWithoutBeingListed) {
  JobSpec spec = spec_of(200, 150, {"bsdf"}, SppBudget{1});
  for (const PixelRect& crop : {PixelRect{0, 0, 200, 150}, PixelRect{3, 5, 190, 149}, PixelRect{7, 7, 8, 8}})
    for (const int tile : {1, 7, 32, 150, 4096}) {
      spec.crop = crop;
      spec.tile = tile;
      EXPECT_EQ(tile_count(spec), tiles_of(spec).size());
    }
  spec = spec_of(65536, 65536, {"bsdf"}, SppBudget{1});
  spec.tile = 1;
  EXPECT_EQ(tile_count(spec), uint64_t{1} << 32);
}

TEST(Planner, OnlyMeasuredBudgetsNeedAPilot) {
  EXPECT_FALSE(needs_pilot(spec_of(8, 8, {"sa"}, SppBudget{4})));
  EXPECT_TRUE(needs_pilot(spec_of(8, 8, {"sa"}, CpuSecondsBudget{4})));
  EXPECT_TRUE(needs_pilot(spec_of(8, 8, {"sa", "auto"}, SppBudget{4})));
  EXPECT_TRUE(needs_pilot(spec_of(8, 8, {"sa"}, TargetErrorBudget{0.1})));
  JobSpec stored = spec_of(8, 8, {"sa"}, CpuSecondsBudget{4});
  stored.plan = {5};
  EXPECT_FALSE(needs_pilot(stored));
  EXPECT_EQ(planned_passes(stored, {})->passes, std::vector<int64_t>{5});
}

TEST(Planner, PassesOfAProbeAreRepetitions) {
  JobSpec spec = spec_of(8, 8, {"sa", "bsdf"}, SppBudget{4096});
  EXPECT_GT(make_plan(spec, {4096, 4096}).group, 1);
  spec.probe = Probe{};
  EXPECT_EQ(make_plan(spec, {4096, 256}).group, 1);
}

TEST(Planner, PilotCostsAShareOfTheBudget) {
  const JobSpec spec = spec_of(640, 360, {"sa", "bsdf"}, CpuSecondsBudget{60});
  const auto tiles = tiles_of(spec);
  double seconds = 0;
  for (size_t t = 0; t < tiles.size(); ++t) {
    const TileTask task = pilot_task(spec, tiles, t);
    EXPECT_EQ(task.kind, TaskKind::kPilot);
    EXPECT_EQ(task.passes.size(), 2u);
    seconds += task.pilot_seconds;
  }
  EXPECT_NEAR(seconds, 0.05 * 60, 1e-9);
}

TEST(Planner, SecondsBecomePasses) {
  const JobSpec spec = spec_of(128, 64, {"sa", "bsdf"}, CpuSecondsBudget{10});
  // Two tiles: 0.1 + 0.3 s per pass of mix 0, 2 + 30 s of mix 1.
  const std::vector<std::vector<MixCost>> pilot = {{{2, 0.2, 0, 0, 0, 0}, {1, 2, 0, 0, 0, 0}},
                                                   {{1, 0.3, 0, 0, 0, 0}, {1, 30, 0, 0, 0, 0}}};
  EXPECT_EQ(planned_passes(spec, pilot)->passes, (std::vector<int64_t>{25, 1}));
  EXPECT_FALSE(planned_passes(spec, {{{0, 0, 0, 0, 0, 0}, {1, 1, 0, 0, 0, 0}}, pilot[1]}).ok());
}

TEST(Planner, ErrorBecomesPasses) {
  const JobSpec spec = spec_of(128, 64, {"sa"}, TargetErrorBudget{0.01});
  // Mean over 128·64 pixels and 3 channels of the one-pass relative variance: 0.5.
  const double sum = 0.5 * 3 * 128 * 64;
  const std::vector<std::vector<MixCost>> pilot = {{{8, 1, 0, 0, 0, 0.25 * sum}},
                                                   {{8, 1, 0, 0, 0, 0.75 * sum}}};
  EXPECT_EQ(planned_passes(spec, pilot)->passes, std::vector<int64_t>{50});
  EXPECT_FALSE(planned_passes(spec, {{{1, 1, 0, 0, 0, 1}}, {{8, 1, 0, 0, 0, 1}}}).ok());
}

/// Every pass of every mix once, in order, in whole groups except at the very end.
void expect_sound(const JobSpec& spec, const std::vector<int64_t>& passes) {
  const Plan plan = make_plan(spec, passes);
  ASSERT_FALSE(plan.boundaries.empty());
  EXPECT_EQ(plan.boundaries.back().passes, passes);
  EXPECT_TRUE(plan.boundaries.back().checkpoint);
  EXPECT_GE(plan.group, 1);
  EXPECT_EQ(plan.group & (plan.group - 1), 0) << "a power of two";
  const auto tiles = tiles_of(spec);
  std::vector<std::vector<int64_t>> reached(tiles.size(), std::vector<int64_t>(passes.size(), 0));
  for (uint64_t i = 0; i < task_count(plan, tiles); ++i) {
    const TileTask task = run_task(spec, plan, tiles, 7, i);
    EXPECT_EQ(task.id, 7 + i);
    EXPECT_EQ(task.tile, tiles[i % tiles.size()]);
    EXPECT_EQ(task.group, plan.group);
    int64_t sum = 0;
    for (size_t m = 0; m < passes.size(); ++m) {
      EXPECT_EQ(task.passes[m].begin, reached[i % tiles.size()][m]);
      if (task.passes[m].count() > 0) {
        EXPECT_EQ(task.passes[m].begin % plan.group, 0) << "a group would be cut in two";
      }
      reached[i % tiles.size()][m] = task.passes[m].end;
      sum += task.passes[m].count();
    }
    EXPECT_GT(sum, 0) << "a task without work";
  }
  for (const auto& tile : reached) EXPECT_EQ(tile, passes);
  int64_t checkpoints = 0;
  for (const PassBoundary& boundary : plan.boundaries) checkpoints += boundary.checkpoint;
  EXPECT_LE(checkpoints, 11);
  const int64_t least = *std::min_element(passes.begin(), passes.end());
  if (least >= 2) {
    EXPECT_GE(least, 2 * plan.group) << "variance needs two groups";
  }
  if (least >= 32) {
    EXPECT_GE(checkpoints, 5);
  }
}

TEST(Planner, PlansAreSound) {
  for (const SamplerKind sampler : {SamplerKind::kIndependent, SamplerKind::kStratified, SamplerKind::kSobol})
    for (const int64_t a : {1, 2, 3, 7, 8, 33, 256, 1000, 100'000})
      for (const int64_t b : {1, 5, 64, 3000}) {
        JobSpec spec = spec_of(130, 70, {"sa:4", "bsdf"}, SppBudget{a});
        spec.sampler = sampler;
        expect_sound(spec, {a, b});
        spec.budget = CpuSecondsBudget{30};
        expect_sound(spec, {a, b});
      }
}

TEST(Planner, LongRunsHaveFinerTimelines) {
  const auto checkpoints = [](double seconds) {
    const Plan plan = make_plan(spec_of(640, 360, {"sa:4"}, CpuSecondsBudget{seconds}), {512});
    return std::count_if(plan.boundaries.begin(), plan.boundaries.end(),
                         [](const PassBoundary& boundary) { return boundary.checkpoint; });
  };
  EXPECT_EQ(checkpoints(1), 3);    // 4 groups of 128: shares below 1/4 are less than one
  EXPECT_EQ(checkpoints(600), 8);  // every group: they grow no longer than two seconds
}

TEST(Planner, IndependentSamplesHaveGroupsOfOne) {
  JobSpec spec = spec_of(64, 64, {"sa"}, SppBudget{256});
  spec.sampler = SamplerKind::kIndependent;
  EXPECT_EQ(make_plan(spec, {256}).group, 1);
  spec.sampler = SamplerKind::kStratified;
  EXPECT_GT(make_plan(spec, {256}).group, 1);
}

TEST(Planner, TasksStayShortAndTheirNumberBounded) {
  const JobSpec spec = spec_of(640, 360, {"sa:4", "bsdf:4"}, CpuSecondsBudget{60});
  const Plan plan = make_plan(spec, {100, 100});
  const auto tiles = tiles_of(spec);
  const double tile_seconds = 2 * 60.0 * 64 * 64 / (640 * 360);
  for (size_t r = 0; r < plan.boundaries.size(); ++r) {
    const int64_t begin = r == 0 ? 0 : plan.boundaries[r - 1].passes[0];
    EXPECT_LE(static_cast<double>(plan.boundaries[r].passes[0] - begin) / 100 * tile_seconds, 1.0);
  }
  JobSpec endless = spec_of(64, 64, {"sa:4"}, SppBudget{int64_t{1} << 38});
  EXPECT_LE(make_plan(endless, {int64_t{1} << 38}).boundaries.size(), 2100u);
}

TEST(Planner, ManyTilesHaveFewRanges) {
  JobSpec spec = spec_of(2048, 1024, {"sa:4"}, SppBudget{int64_t{1} << 30});
  spec.tile = 8;
  const Plan plan = make_plan(spec, {int64_t{1} << 30});
  EXPECT_LE(task_count(plan, tiles_of(spec)), uint64_t{1} << 22);
}

TEST(Planner, APlanDependsOnNothingElse) {
  const JobSpec spec = spec_of(300, 200, {"sa:4", "bsdf:4"}, CpuSecondsBudget{20});
  EXPECT_EQ(make_plan(spec, {40, 60}), make_plan(spec, {40, 60}));
  const auto tiles = tiles_of(spec);
  std::set<uint64_t> shuffles;
  const Plan plan = make_plan(spec, {40, 60});
  for (uint64_t i = 0; i < task_count(plan, tiles); ++i)
    shuffles.insert(run_task(spec, plan, tiles, 0, i).shuffle);
  EXPECT_EQ(shuffles.size(), task_count(plan, tiles));
}

}  // namespace
}  // namespace penumbra
