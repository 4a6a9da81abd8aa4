#include "server/stages.h"

#include <gtest/gtest.h>

#include <numeric>

#include "proto/auto_plan.h"
#include "server/auto_planner.h"
#include "server/replanner.h"

namespace penumbra {
namespace {

JobSpec spec_of(std::vector<const char*> mixes, double seconds) {
  JobSpec spec;
  spec.bundle = Digest(64, 'a');
  for (const char* mix : mixes) spec.mixes.push_back(*parse_mix(mix));
  spec.budget = CpuSecondsBudget{seconds};
  spec.width = 192;
  spec.height = 128;
  spec.crop = {0, 0, 192, 128};
  return spec;
}

constexpr double kPassSeconds = 0.01;  ///< of a tile, as the pilots here say

/// Six tiles, of which each mix and each candidate of `auto` has measured the same.
std::vector<std::vector<MixCost>> pilot_of(const JobSpec& spec) {
  std::vector<MixCost> tile;
  for (const Mix& mix : spec.mixes) {
    MixCost cost;
    if (!mix.automatic) cost = {2, 2 * kPassSeconds, 0, 0, 0, 0};
    tile.push_back(cost);
  }
  for (size_t a = 0; a < automatic_mixes(spec.mixes).size(); ++a)
    for (size_t k = 0; k < auto_candidates().size(); ++k) {
      MixCost cost;
      cost.passes = 4;
      cost.pixels = 64;
      cost.cpu_seconds = kPassSeconds * 4 * 64 / (64 * 64);
      cost.relative_variance = 64;
      cost.relative_variance_squares = 64;
      tile.push_back(cost);
    }
  return std::vector<std::vector<MixCost>>(6, tile);
}

/// Workers that are `slow` times as slow as in the pilot, and whose kept passes take `kept` seconds.
struct Workers {
  const JobSpec& spec;
  double slow = 1, kept = 1;
  std::vector<MixCost> costs = {};

  CostsOf results(const Plan& plan) {
    return [this, plan](uint64_t i) -> const std::vector<MixCost>* {
      costs.clear();
      for (const PassRange& range : run_task(spec, plan, tiles_of(spec), 0, i).repilot) {
        MixCost cost;
        cost.cpu_seconds = kept;
        cost.repilot_passes = range.count();
        cost.repilot_seconds = static_cast<double>(range.count()) * kPassSeconds * slow;
        costs.push_back(cost);
      }
      return costs.empty() ? nullptr : &costs;
    };
  }
};

PlannedPasses next_of(const JobSpec& spec, const PlannedPasses& planned, double slow, double kept = 1) {
  Workers workers{spec, slow, kept};
  const auto next = replanned(spec, pilot_of(spec), planned, workers.results(make_plan(spec, planned)));
  EXPECT_TRUE(next.ok()) << next.status();
  return next.value_or(PlannedPasses());
}

TEST(Stages, OneStageIsWhatItWas) {
  EXPECT_EQ(passes_at(0.5, {{1, 100}}, 8), 48);
  EXPECT_EQ(passes_at(0.99, {{1, 9}}, 8), 8);
  EXPECT_EQ(passes_at(1, {{1, 100}}, 8), 100);
}

TEST(Stages, PassesAscendInWholeGroupsWhateverIsPlannedAnew) {
  for (const int64_t group : {1, 4, 16})
    for (const int64_t first : {1, 3, 17, 64, 100, 1000})
      for (const double change : {0.8, 1.0, 1.3}) {
        const auto changed = static_cast<int64_t>(static_cast<double>(first) * change);
        const int64_t second = std::max(changed, passes_at(0.75, {{0.75, first}, {1, first}}, group));
        const std::vector<Stage> stages{{0.75, first}, {0.875, second}, {1, second}};
        int64_t before = 0;
        for (int i = 1; i <= 64; ++i) {
          const int64_t passes = passes_at(i / 64., stages, group);
          EXPECT_GE(passes, before);
          if (i < 64) {
            EXPECT_TRUE(passes % group == 0 || passes == second) << passes;
          }
          before = passes;
        }
        EXPECT_EQ(before, second);
      }
}

TEST(Stages, WhatIsSureStaysAndTheLastPlanReplays) {
  for (const double seconds : {0.3, 5.0, 60.0})
    for (const double slow : {0.7, 1.0, 1.2, 30.0}) {
      JobSpec spec = spec_of({"sa:4", "auto", "bsdf:1"}, seconds);
      PlannedPasses planned = *planned_passes(spec, pilot_of(spec));
      ASSERT_EQ(planned.open.size(), 2u);
      std::vector<TileTask> sure;
      while (true) {
        ASSERT_TRUE(check_stages(spec, planned).ok()) << check_stages(spec, planned);
        const Plan plan = make_plan(spec, planned);
        const auto tiles = tiles_of(spec);
        for (size_t i = 0; i < sure.size(); ++i) EXPECT_EQ(run_task(spec, plan, tiles, 0, i), sure[i]);
        sure.clear();
        for (uint64_t i = 0; i < plan.sure * tiles.size(); ++i)
          sure.push_back(run_task(spec, plan, tiles, 0, i));
        EXPECT_LE(plan.measured, plan.sure);
        if (planned.open.empty()) break;
        planned = next_of(spec, planned, slow);
      }
      EXPECT_EQ(planned.earlier.size(), 2u);
      // As run.json has it.
      spec.plan = planned.passes;
      spec.auto_plans = planned.autos;
      spec.earlier_plans = planned.earlier;
      const Plan stored = make_plan(spec, *planned_passes(spec, {}));
      ASSERT_EQ(task_count(stored, tiles_of(spec)), sure.size());
      for (uint64_t i = 0; i < sure.size(); ++i) {
        sure[i].repilot.clear();  // there is nothing to find out
        EXPECT_EQ(run_task(spec, stored, tiles_of(spec), 0, i), sure[i]);
      }
    }
}

TEST(Stages, APlanThatTakesBackPassesIsRefused) {
  const JobSpec spec = spec_of({"sa:4"}, 5);
  EXPECT_TRUE(check_stages(spec, {{80}, {}, {{0.75, {100}, {}}}}).ok());
  EXPECT_FALSE(check_stages(spec, {{40}, {}, {{0.75, {100}, {}}}}).ok());
}

TEST(Stages, OnlyABudgetOfSecondsWithoutAPlanHasThem) {
  JobSpec spec = spec_of({"sa:4"}, 5);
  EXPECT_FALSE(borders_of(spec).empty());
  spec.plan = {10};
  EXPECT_TRUE(borders_of(spec).empty());
  spec.plan.clear();
  spec.budget = SppBudget{10};
  EXPECT_TRUE(borders_of(spec).empty());
  const Plan plan = make_plan(spec, *planned_passes(spec, {}));
  EXPECT_EQ(plan.sure, plan.boundaries.size());
  for (uint64_t i = 0; i < task_count(plan, tiles_of(spec)); ++i)
    EXPECT_TRUE(run_task(spec, plan, tiles_of(spec), 0, i).repilot.empty());
}

TEST(Replanner, RepeatedPassesAreFewAndReachEveryTileAndMix) {
  const JobSpec spec = spec_of({"sa:4", "bsdf:1"}, 20);
  const Plan plan = make_plan(spec, *planned_passes(spec, pilot_of(spec)));
  const auto tiles = tiles_of(spec);
  int64_t kept = 0, repeated = 0;
  std::vector<std::vector<int64_t>> per(tiles.size(), std::vector<int64_t>(2, 0));
  for (uint64_t i = 0; i < task_count(plan, tiles); ++i) {
    const TileTask task = run_task(spec, plan, tiles, 0, i);
    for (size_t m = 0; m < task.repilot.size(); ++m) {
      EXPECT_EQ(task.repilot[m].begin, per[i % tiles.size()][m]);
      per[i % tiles.size()][m] += task.repilot[m].count();
      repeated += task.repilot[m].count();
      kept += task.passes[m].count();
    }
  }
  // 60 of each mix, were the border not moved down to whole groups.
  EXPECT_LE(repeated, 2 * 60);
  EXPECT_GE(repeated, 2 * 40);
  EXPECT_LT(static_cast<double>(repeated) / static_cast<double>(kept), 0.05);
  for (const auto& mixes : per)
    for (const int64_t count : mixes) EXPECT_GT(count, 3);
}

TEST(Replanner, TotalsFollowTheRepeatedPassesAndNothingElse) {
  const JobSpec spec = spec_of({"sa:4", "bsdf:1"}, 60);
  const PlannedPasses first = *planned_passes(spec, pilot_of(spec));
  EXPECT_EQ(first.passes, (std::vector<int64_t>{1000, 1000}));
  EXPECT_EQ(next_of(spec, first, 1).passes, first.passes);
  const PlannedPasses slower = next_of(spec, first, 1.2);
  EXPECT_NEAR(static_cast<double>(slower.passes[0]), 1000 / 1.2, 5);
  EXPECT_EQ(slower.earlier[0].passes, first.passes);
  EXPECT_EQ(slower.open, std::vector<double>{kStageBorders[1]});
  EXPECT_EQ(next_of(spec, first, 1.2, 1000), slower) << "what is kept has no say";
  EXPECT_NEAR(static_cast<double>(next_of(spec, slower, 0.9).passes[0]), 1000 / 0.9, 10);
}

TEST(Replanner, NothingIsTakenBack) {
  const JobSpec spec = spec_of({"sa:4", "auto"}, 60);
  const PlannedPasses first = *planned_passes(spec, pilot_of(spec));
  const Plan plan = make_plan(spec, first);
  const PlannedPasses next = next_of(spec, first, 100);
  EXPECT_EQ(next.passes[0], plan.boundaries[plan.sure - 1].passes[0]);
  for (size_t t = 0; t < 6; ++t)
    EXPECT_EQ(next.autos[0].tiles[t].passes, run_range(plan, plan.sure - 1, t, 1).end);
}

TEST(Replanner, WithoutAWordThePilotsStands) {
  const JobSpec spec = spec_of({"sa:4", "auto"}, 60);
  const PlannedPasses first = *planned_passes(spec, pilot_of(spec));
  const std::vector<MixCost> silent(2);
  const auto next = replanned(spec, pilot_of(spec), first, [&](uint64_t) { return &silent; });
  ASSERT_TRUE(next.ok());
  EXPECT_EQ(next->passes[0], first.passes[0]);
  EXPECT_EQ((Speed{0, 0, 0}.factor()), 1);
  EXPECT_EQ((Speed{1, 2, 1}.factor()), 1.5) << "one pass is worth as much as the pilot's word";
}

TEST(Replanner, WhatTilesDoStaysThoughThePilotWouldSayOtherwiseNow) {
  const JobSpec spec = spec_of({"auto"}, 20);
  PlannedPasses planned = *planned_passes(spec, pilot_of(spec));
  TilePlan& tile = planned.autos[0].tiles[2];
  tile.candidate = tile.candidate == 1 ? 2 : 1;
  tile.shares.assign(64, 200);  // as another version of the planner had it
  const PlannedPasses next = next_of(spec, planned, 1.2);
  ASSERT_EQ(next.autos.size(), 1u);
  EXPECT_EQ(next.autos[0].tiles[2].candidate, tile.candidate);
  EXPECT_EQ(next.autos[0].tiles[2].shares, tile.shares);
}

TEST(Replanner, AutoSpendsItsBudgetOnAllThatIsItsOwn) {
  const JobSpec spec = spec_of({"auto"}, 20);
  const auto pilot = pilot_of(spec);
  for (const double slow : {0.8, 1.0, 1.25}) {
    PlannedPasses planned = *planned_passes(spec, pilot);
    while (!planned.open.empty()) planned = next_of(spec, planned, slow);
    double seconds = 0;
    for (const auto& tile : pilot)
      for (const MixCost& cost : tile) seconds += cost.cpu_seconds + cost.overhead_seconds;
    for (const TilePlan& tile : planned.autos[0].tiles)
      seconds += static_cast<double>(tile.passes) * kPassSeconds * slow;
    const Plan plan = make_plan(spec, planned);
    for (uint64_t i = 0; i < task_count(plan, tiles_of(spec)); ++i)
      for (const PassRange& range : run_task(spec, plan, tiles_of(spec), 0, i).repilot)
        seconds += static_cast<double>(range.count()) * kPassSeconds * slow;
    EXPECT_NEAR(seconds, 20, 0.2) << slow;  // a word of the pilot's own is left
  }
}

}  // namespace
}  // namespace penumbra
