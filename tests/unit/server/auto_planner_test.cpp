#include "server/auto_planner.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "proto/blocks.h"
#include "server/planner.h"
#include "server/replanner.h"

namespace penumbra {
namespace {

constexpr int kTile = 64;
constexpr double kTilePixels = kTile * kTile;

/// What a pilot has found of one candidate in one tile: per pixel and pass.
struct Found {
  double variance = 1;  ///< relative, summed over channels
  double seconds = 1e-6;
  double work = 1;
};

JobSpec spec_of(int tiles, Budget budget, std::vector<const char*> mixes = {"auto"}) {
  JobSpec spec;
  spec.bundle = Digest(64, 'a');
  for (const char* mix : mixes) spec.mixes.push_back(*parse_mix(mix));
  spec.budget = budget;
  spec.tile = kTile;
  spec.width = kTile * tiles;
  spec.height = kTile;
  spec.crop = {0, 0, spec.width, spec.height};
  return spec;
}

MixCost cost_of(const Found& found, int64_t pixels) {
  MixCost cost;
  cost.passes = 4;
  cost.pixels = pixels;
  cost.cpu_seconds = found.seconds * static_cast<double>(4 * pixels);
  cost.work = found.work * static_cast<double>(4 * pixels);
  cost.relative_variance = found.variance * static_cast<double>(pixels);
  cost.relative_variance_squares = found.variance * found.variance * static_cast<double>(pixels);
  return cost;
}

/// All candidates alike, except where `set` says otherwise.
using Pilot = std::vector<std::vector<MixCost>>;
Pilot uniform_pilot(int tiles, int64_t pixels = 1024) {
  std::vector<MixCost> tile(1 + auto_candidates().size(), cost_of({}, pixels));
  tile[0] = {};  // of the mix itself: no whole pass
  return Pilot(static_cast<size_t>(tiles), tile);
}
void set(Pilot& pilot, int tile, int candidate, const Found& found, int64_t pixels = 1024) {
  pilot[static_cast<size_t>(tile)][static_cast<size_t>(1 + candidate)] = cost_of(found, pixels);
}

AutoPlan planned(const JobSpec& spec, const Pilot& pilot) {
  const auto plan = plan_auto(spec, tiles_of(spec), pilot, 0);
  EXPECT_TRUE(plan.ok()) << plan.status();
  return plan.value_or(AutoPlan());
}

TEST(AutoPlanner, EachTileTakesItsCheapestError) {
  Pilot pilot = uniform_pilot(6);
  set(pilot, 0, 3, {0.1, 2e-6, 2});    // a tenth of the variance at twice the cost
  set(pilot, 1, 2, {1, 0.2e-6, 0.2});  // the same for a fifth
  set(pilot, 2, 4, {0.5, 4e-6, 4});    // half the error, but at four times the cost: no bargain
  const AutoPlan plan = planned(spec_of(6, CpuSecondsBudget{10}), pilot);
  ASSERT_EQ(plan.tiles.size(), 6u);
  EXPECT_EQ(plan.candidates, auto_candidates());
  EXPECT_EQ(plan.mix, 0);
  EXPECT_EQ(plan.tiles[0].candidate, 3);
  EXPECT_EQ(plan.tiles[1].candidate, 2);
  EXPECT_NE(plan.tiles[2].candidate, 4);
}

TEST(AutoPlanner, PassesFollowTheErrorAndSpendTheBudget) {
  Pilot pilot = uniform_pilot(4);
  const auto everywhere = [&](int tile, const Found& found) {
    for (size_t k = 0; k < auto_candidates().size(); ++k) set(pilot, tile, static_cast<int>(k), found);
  };
  everywhere(1, {4, 1e-6, 1});  // √4: twice the passes
  everywhere(2, {1, 4e-6, 4});  // √(1/4): half
  const AutoPlan plan = planned(spec_of(4, CpuSecondsBudget{10}), pilot);
  double pilot_seconds = 0, seconds = 0;
  for (const auto& tile : pilot)
    for (size_t k = 1; k < tile.size(); ++k) pilot_seconds += tile[k].cpu_seconds;
  const double cost[] = {1e-6, 1e-6, 4e-6, 1e-6};
  for (size_t t = 0; t < 4; ++t) seconds += cost[t] * kTilePixels * static_cast<double>(plan.tiles[t].passes);
  EXPECT_NEAR(seconds, 10 - pilot_seconds, 0.1);
  const auto n = [&](size_t t) { return static_cast<double>(plan.tiles[t].passes); };
  EXPECT_NEAR(n(1) / n(0), 2, 0.05);
  EXPECT_NEAR(n(2) / n(0), 0.5, 0.02);
}

TEST(AutoPlanner, WholePassesTellWhatBlocksDoNot) {
  Pilot pilot = uniform_pilot(4);
  const double before = static_cast<double>(planned(spec_of(4, CpuSecondsBudget{10}), pilot).tiles[1].passes);
  pilot[2][0].passes = 1;
  pilot[2][0].cpu_seconds = 2e-6 * kTilePixels;  // twice what its blocks said
  const double after = static_cast<double>(planned(spec_of(4, CpuSecondsBudget{10}), pilot).tiles[1].passes);
  EXPECT_NEAR(after / before, 0.5, 0.01);
}

/// Whole passes of candidate `k`, which found `deviation` in the left half of the tile and `rest` in the
/// right.
void set_whole(Pilot& pilot, int tile, int k, float deviation, float rest) {
  MixCost& cost = pilot[static_cast<size_t>(tile)][0];
  cost.passes = 2;
  cost.candidate = k;
  cost.cpu_seconds = 2e-6 * kTilePixels;
  for (int b = 0; b < 64; ++b) cost.blocks.push_back({64 * (b % 8 < 4 ? deviation : rest), 64e-6f});
}

TEST(AutoPlanner, BlocksShareInPassesByTheirError) {
  Pilot pilot = uniform_pilot(2);
  set_whole(pilot, 0, 3, 1, 0.2f);
  set_whole(pilot, 1, 3, 1, 1);
  const JobSpec spec = spec_of(2, CpuSecondsBudget{10});
  const AutoPlan plan = planned(spec, pilot);
  ASSERT_EQ(plan.tiles[0].shares.size(), 64u);
  EXPECT_EQ(plan.tiles[0].shares[0], 255);
  EXPECT_LT(plan.tiles[0].shares[7], 128);
  EXPECT_TRUE(plan.tiles[1].shares.empty()) << "all blocks are alike";
  // As noisy on the whole as the other tile, and all of that in one half.
  EXPECT_GT(static_cast<double>(plan.tiles[0].passes) / static_cast<double>(plan.tiles[1].passes), 1.05);
  const auto tiles = tiles_of(spec);
  double pilot_seconds = 0, seconds = 0;
  for (const auto& tile : pilot)
    for (const MixCost& cost : tile) pilot_seconds += cost.cpu_seconds;
  for (size_t t = 0; t < 2; ++t)
    seconds += 1e-6 * kTilePixels * static_cast<double>(plan.tiles[t].passes) *
               mean_share(tiles[t], plan.tiles[t].shares);
  EXPECT_NEAR(seconds, 10 - pilot_seconds - expected_repilot_seconds(spec), 0.5);
  // The mean over the pixels is what counts as the mix's passes, and the smallest share has two groups.
  const int64_t mean = mean_passes(spec, tiles, plan);
  EXPECT_LT(mean, plan.tiles[0].passes);
  const Plan run = make_plan(spec, {mean}, {plan});
  EXPECT_GE(plan.tiles[0].passes * plan.tiles[0].shares[7] / 255, 2 * run.groups[0][0]);
  EXPECT_EQ(run_task(spec, run, tiles, 0, 0).chosen[0].shares, plan.tiles[0].shares);
  // In whole groups it is a little more.
  EXPECT_GE(run.boundaries.back().passes[0], mean);
  EXPECT_LE(run.boundaries.back().passes[0], mean + run.groups[0][0]);
  // With a given number of passes every pixel has that number.
  EXPECT_TRUE(planned(spec_of(2, SppBudget{16}), pilot).tiles[0].shares.empty());
}

TEST(AutoPlanner, NoTileIsLeftAlone) {
  Pilot pilot = uniform_pilot(4);
  for (size_t k = 0; k < auto_candidates().size(); ++k)
    set(pilot, 3, static_cast<int>(k), {0, 1e-6, 1});  // nothing has varied in the pilot's few pixels
  const AutoPlan plan = planned(spec_of(4, CpuSecondsBudget{10}), pilot);
  EXPECT_GT(static_cast<double>(plan.tiles[3].passes), 0.25 * static_cast<double>(plan.tiles[0].passes));
  for (const TilePlan& tile : planned(spec_of(4, CpuSecondsBudget{1e-9}), pilot).tiles)
    EXPECT_EQ(tile.passes, 1);
}

TEST(AutoPlanner, FewPixelsDoNotOverruleTheImage) {
  // Candidate 3 is wild: in one tile of eight a rare sample has shown it, in the others it was missed.
  Pilot pilot = uniform_pilot(8, 16);
  for (int t = 0; t < 8; ++t) set(pilot, t, 3, {t == 5 ? 1000.0 : 0.9, 1e-6, 1}, 16);
  for (const TilePlan& tile : planned(spec_of(8, CpuSecondsBudget{10}), pilot).tiles)
    EXPECT_NE(tile.candidate, 3);
}

/// What a pilot of four passes has not seen may happen in one of ten.
TEST(AutoPlanner, NoPixelHasFewerThanEightPassesOrAPartOfTheMean) {
  for (const double seconds : {0.35, 2.0, 20.0}) {
    Pilot pilot = uniform_pilot(4);
    for (size_t t = 0; t < 4; ++t) set_whole(pilot, static_cast<int>(t), 0, 1, 0.01f);
    for (size_t k = 0; k < auto_candidates().size(); ++k) set(pilot, 2, static_cast<int>(k), {100, 1e-6, 1});
    const JobSpec spec = spec_of(4, CpuSecondsBudget{seconds});
    const AutoPlan plan = planned(spec, pilot);
    double mean = 0, least = 1e9;
    for (const TilePlan& tile : plan.tiles) {
      mean += static_cast<double>(tile.passes) * mean_share(tiles_of(spec)[0], tile.shares) / 4;
      ASSERT_TRUE(tile.shares.empty() || tile.shares.size() == 64u);
      const int share =
          tile.shares.empty() ? kWholeShare : *std::min_element(tile.shares.begin(), tile.shares.end());
      least = std::min(least, static_cast<double>(tile.passes) * share / kWholeShare);
    }
    EXPECT_GE(least, 0.9 * std::min(8.0, 0.6 * mean)) << seconds << " s, " << mean << " passes";
    if (seconds > 10) {
      EXPECT_LT(least, 0.4 * mean) << "where passes are many, blocks may have few";
    }
  }
}

/// Where a lobe may be narrow a few pixels cannot tell how bright its rare bright samples are.
TEST(AutoPlanner, TilesWithLobesAndThoseBesideThemTakeNoMixWithoutBsdf) {
  const JobSpec spec = spec_of(6, CpuSecondsBudget{10});
  const auto& all = auto_candidates();
  const auto points = static_cast<int>(std::find(all.begin(), all.end(), *parse_mix("sa:4")) - all.begin());
  ASSERT_FALSE(is_bounded(all.at(static_cast<size_t>(points))));
  Pilot pilot = uniform_pilot(6);
  for (int t = 0; t < 6; ++t) set(pilot, t, points, {0.1});
  pilot[1][1].lobed_pixels = 1;
  const AutoPlan plan = planned(spec, pilot);
  for (size_t t = 0; t < 6; ++t) EXPECT_EQ(plan.tiles[t].candidate == points, t > 2) << "tile " << t;
}

TEST(AutoPlanner, PassCountsPlanFromWorkAlone) {
  Pilot pilot = uniform_pilot(3);
  set(pilot, 1, 2, {1, 1e-6, 0.2});
  const JobSpec spec = spec_of(3, SppBudget{17});
  const AutoPlan plan = planned(spec, pilot);
  EXPECT_EQ(plan.tiles[1].candidate, 2);
  for (const TilePlan& tile : plan.tiles) EXPECT_EQ(tile.passes, 17);
  for (auto& tile : pilot)
    for (MixCost& cost : tile) cost.cpu_seconds *= 0.5 + 0.3 * static_cast<double>(&cost - tile.data());
  EXPECT_EQ(planned(spec, pilot), plan) << "a clock has had its say";
}

TEST(AutoPlanner, WhatIsBeyondAllNumbersIsRefused) {
  for (const Found& found : {Found{1e300, 1e-6, 1}, Found{1, 1e300, 1}, Found{1, 1e-300, 1}}) {
    Pilot pilot = uniform_pilot(2);
    for (size_t k = 0; k < auto_candidates().size(); ++k)
      for (int t = 0; t < 2; ++t) set(pilot, t, static_cast<int>(k), found);
    const JobSpec spec = spec_of(2, CpuSecondsBudget{10});
    EXPECT_EQ(plan_auto(spec, tiles_of(spec), pilot, 0).status().code(), absl::StatusCode::kInternal);
  }
}

TEST(AutoPlanner, ATargetIsMet) {
  Pilot pilot = uniform_pilot(4);
  for (size_t k = 0; k < auto_candidates().size(); ++k) set(pilot, 2, static_cast<int>(k), {9, 1e-6, 1});
  const AutoPlan plan = planned(spec_of(4, TargetErrorBudget{1e-3}), pilot);
  const double variance[] = {1, 1, 9, 1};
  double error = 0;
  for (size_t t = 0; t < 4; ++t) error += variance[t] / static_cast<double>(plan.tiles[t].passes) / 4 / 3;
  EXPECT_LE(error, 1.001e-3);
  EXPECT_GE(error, 0.98e-3);
  for (const TilePlan& tile : planned(spec_of(4, TargetErrorBudget{1e9}), pilot).tiles)
    EXPECT_EQ(tile.passes, 2) << "an error needs two passes to be known";
}

TEST(AutoPlanner, CandidatesThatWereNotMeasuredAreNotChosen) {
  Pilot pilot = uniform_pilot(2);
  for (auto& tile : pilot)
    for (size_t k = 0; k < auto_candidates().size(); ++k)
      if (k != 5) tile[1 + k] = {};
  for (const TilePlan& tile : planned(spec_of(2, CpuSecondsBudget{10}), pilot).tiles)
    EXPECT_EQ(tile.candidate, 5);
}

TEST(AutoPlanner, APilotThatMeasuredNothingIsAnError) {
  const JobSpec spec = spec_of(2, CpuSecondsBudget{10});
  Pilot pilot = uniform_pilot(2);
  for (MixCost& cost : pilot[1]) cost = {};
  EXPECT_EQ(plan_auto(spec, tiles_of(spec), pilot, 0).status().code(), absl::StatusCode::kInternal);
  pilot = uniform_pilot(2);
  pilot[0].pop_back();
  EXPECT_EQ(plan_auto(spec, tiles_of(spec), pilot, 0).status().code(), absl::StatusCode::kInternal);
}

TEST(AutoPlanner, TasksCarryWhatStandsForAuto) {
  JobSpec spec = spec_of(2, CpuSecondsBudget{10}, {"sa:4", "auto"});
  const auto tiles = tiles_of(spec);
  const TileTask pilot = pilot_task(spec, tiles, 0);
  EXPECT_EQ(pilot.chosen.size(), auto_candidates().size());
  EXPECT_EQ(costs_of(pilot), 2 + auto_candidates().size());
  EXPECT_GT(pilot.passes[0].count(), 0);
  EXPECT_GE(pilot.passes[1].count(), 2) << "whole passes";
  EXPECT_EQ(pilot_task(spec_of(2, SppBudget{8}), tiles, 0).passes[0].count(), 0);

  const AutoPlan plan{1, auto_candidates(), {{2, 100}, {5, 7}}};
  const Plan run = make_plan(spec, {40, 54}, {plan});
  int64_t done[2] = {0, 0};
  for (uint64_t i = 0; i < task_count(run, tiles); ++i) {
    const TileTask task = run_task(spec, run, tiles, 0, i);
    const size_t t = i % 2;
    ASSERT_EQ(task.chosen.size(), 1u);
    EXPECT_EQ(costs_of(task), 2u);
    EXPECT_EQ(task.chosen[0].mix, 1);
    EXPECT_EQ(task.chosen[0].chosen, auto_candidates()[t == 0 ? 2 : 5]);
    EXPECT_EQ(task.passes[1].begin, done[t]);
    if (i < 2) {
      EXPECT_GT(task.passes[1].count(), 0) << "the first range is a whole picture";
    }
    if (task.passes[1].count() > 0) {
      EXPECT_EQ(task.passes[1].begin % task.chosen[0].group, 0) << "a group would be cut in two";
    }
    done[t] = task.passes[1].end;
  }
  EXPECT_EQ(done[0], 100);
  EXPECT_EQ(done[1], 7);
  EXPECT_GT(run.groups[0][0], run.groups[0][1]) << "few passes need small groups";
  EXPECT_EQ(run.boundaries.back().passes, (std::vector<int64_t>{40, 54}));
}

TEST(AutoPlanner, OtherMixesArePlannedAsWithoutAuto) {
  const std::vector<MixCost> fixed = {{2, 0.02, 0, 0, 0, 0}};
  const JobSpec alone = spec_of(2, CpuSecondsBudget{10}, {"sa:4"}),
                both = spec_of(2, CpuSecondsBudget{10}, {"sa:4", "auto"});
  Pilot pilot = uniform_pilot(2);
  for (auto& tile : pilot) tile.insert(tile.begin(), fixed[0]);
  const auto a = planned_passes(alone, {fixed, fixed}), b = planned_passes(both, pilot);
  ASSERT_TRUE(a.ok() && b.ok());
  EXPECT_EQ(a->passes[0], b->passes[0]);
  EXPECT_EQ(make_plan(alone, a->passes).group, make_plan(both, b->passes, b->autos).group);
}

}  // namespace
}  // namespace penumbra
