#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "client/against.h"
#include "client/gate_run.h"
#include "client/noise_floor.h"
#include "client/run_json.h"
#include "proto/status.h"
#include "tests/unit/client/sample_run.h"

namespace penumbra {
namespace {

using testing::HasSubstr;
using testing::Not;

RunRecord gated_run() {
  RunRecord run = sample_run();
  for (MixSummary& mix : run.summary.mixes) mix.calibration = {100, 0.01};
  for (MixRecord& mix : run.mixes) {
    mix.error->blocks = {8, {0.5, 0.4, 0.6, 0.7, 0.3, 0.5, 0.55, 0.45}};
    mix.error->relmse_ci = ConfidenceInterval{0.49, 0.51};
  }
  return run;
}

absl::StatusOr<GateResult> gate(const Json& now, const Json& before, const GateOptions& options = {}) {
  return gate_runs(now, "run.json", before, "base.json", options);
}

TEST(Judge, NeedsTheWholeIntervalOnOneSide) {
  const double inf = INFINITY;
  EXPECT_EQ(judge({std::log(1.2), 0.01, inf}, 0.05, 2), Verdict::kWorse);
  EXPECT_EQ(judge({std::log(1.2), 0.10, inf}, 0.05, 2), Verdict::kInconclusive);
  EXPECT_EQ(judge({0, 0.01, inf}, 0.05, 2), Verdict::kPass);
  EXPECT_EQ(judge({0, 0.10, inf}, 0.05, 2), Verdict::kInconclusive) << "a short run does not pass by luck";
  EXPECT_EQ(judge({std::log(1.2), 0, inf}, 0.05, 2), Verdict::kWorse);
  EXPECT_EQ(judge({std::log(1.2), 0.04, inf}, 0.05, 1), Verdict::kWorse);
  EXPECT_EQ(judge({std::log(1.2), 0.04, inf}, 0.05, 100), Verdict::kInconclusive) << "Šidák";
  EXPECT_EQ(judge({std::log(1.2), 0.01, inf}, 0.30, 2), Verdict::kPass) << "within the tolerance";
}

TEST(Worst, OneWorseFigureDecides) {
  EXPECT_EQ(worst({Verdict::kPass, Verdict::kInconclusive, Verdict::kWorse}), Verdict::kWorse);
  EXPECT_EQ(worst({Verdict::kPass, Verdict::kInconclusive}), Verdict::kInconclusive);
  EXPECT_EQ(worst({Verdict::kPass, Verdict::kPass}), Verdict::kPass);
  EXPECT_EQ(worst({}), Verdict::kInconclusive);
}

TEST(GateRuns, ARunPassesAgainstItself) {
  const Json run = run_json(gated_run());
  const auto result = gate(run, run);
  ASSERT_TRUE(result.ok()) << result.status();
  EXPECT_EQ(result->verdict, Verdict::kPass) << gate_text(*result);
  ASSERT_EQ(result->rows.size(), 4u);
  EXPECT_EQ(result->rows[0].log_ratio->value, 0);
}

TEST(GateRuns, ErrorIsPerPassAndCpuPerPassInUnits) {
  RunRecord before = gated_run();
  before.summary.spec.sampler = SamplerKind::kIndependent;
  RunRecord now = before;
  MixSummary& mix = now.summary.mixes[0];
  mix.passes = 128;  // twice the passes at half the error, twice the time: nothing has changed
  mix.cpu_seconds = 38;
  now.mixes[0].error->relmse = 0.25;
  for (double& v : now.mixes[0].error->blocks.relmse) v /= 2;
  for (MixSummary& m : now.summary.mixes) m.calibration = {100, 0.02};  // on a machine of half the speed
  now.summary.mixes[1].cpu_seconds = 19;
  const auto result = gate(run_json(now), run_json(before));
  ASSERT_TRUE(result.ok()) << result.status();
  for (const GateRow& row : result->rows)
    EXPECT_NEAR(row.log_ratio->value, 0, 1e-12) << row.mix << row.figure;
}

TEST(GateRuns, OtherNumbersOfStratifiedPassesDecideNothingOfTheError) {
  RunRecord now = gated_run();
  ASSERT_NE(now.summary.spec.sampler, SamplerKind::kIndependent);
  now.summary.mixes[0].passes = 63;
  now.mixes[0].error->relmse *= 2;
  const auto result = gate(run_json(now), run_json(gated_run()));
  ASSERT_TRUE(result.ok()) << result.status();
  EXPECT_EQ(result->verdict, Verdict::kInconclusive);
  EXPECT_EQ(result->rows[0].verdict, Verdict::kInconclusive);
  EXPECT_THAT(result->rows[0].note, HasSubstr("63 passes, and 64 before"));
  EXPECT_TRUE(result->rows[1].verdict.has_value()) << "CPU per pass is judged all the same";
}

TEST(GateRuns, ALargerErrorIsWorse) {
  RunRecord now = gated_run();
  now.mixes[1].error->relmse *= 1.2;
  const auto result = gate(run_json(now), run_json(gated_run()));
  ASSERT_TRUE(result.ok()) << result.status();
  EXPECT_EQ(result->verdict, Verdict::kWorse);
  EXPECT_EQ(result->rows[0].verdict, Verdict::kPass);
  EXPECT_EQ(result->rows[2].verdict, Verdict::kWorse);
  EXPECT_THAT(gate_text(*result), HasSubstr("1.200"));
  EXPECT_EQ(gate_json(*result)["verdict"], "worse");
}

RunRecord run_with_variance() {
  RunRecord run = gated_run();
  for (MixRecord& mix : run.mixes) {
    mix.error->variance = mix.error->relmse;
    mix.error->blocks.variance = mix.error->blocks.relmse;
  }
  return run;
}

const GateRow& row_of(const GateResult& result, const std::string& figure) {
  for (const GateRow& row : result.rows)
    if (row.figure == figure) return row;
  PENUMBRA_CHECK(false);
}

TEST(GateRuns, VarianceSaysTheErrorWhereBothRunsKnowIt) {
  RunRecord now = run_with_variance();
  now.mixes[0].error->relmse *= 1.1;  // one draw of the noise
  now.mixes[0].error->variance = *now.mixes[0].error->variance * 1.2;
  const auto result = gate(run_json(now), run_json(run_with_variance()));
  ASSERT_TRUE(result.ok()) << result.status();
  EXPECT_NEAR(row_of(*result, "error per pass").log_ratio->value, std::log(1.2), 1e-12);
  EXPECT_EQ(result->verdict, Verdict::kWorse);
  const auto old_baseline = gate(run_json(now), run_json(gated_run()));
  EXPECT_NEAR(row_of(*old_baseline, "error per pass").log_ratio->value, std::log(1.1), 1e-12);
}

TEST(GateRuns, OutliersDoNotHideWhatIsWorseEverywhere) {
  RunRecord before = run_with_variance(), now = before;
  for (RunRecord* run : {&before, &now}) {
    std::vector<double>& variance = run->mixes[0].error->blocks.variance;
    variance.assign(200, run == &now ? 1.2 : 1.0);
    variance[run == &now ? 7 : 90] = 100;  // a third of all, elsewhere in each run
    run->mixes[0].error->blocks.relmse = variance;
    run->mixes[0].error->variance = run->mixes[0].error->relmse;
  }
  const auto result = gate(run_json(now), run_json(before));
  ASSERT_TRUE(result.ok()) << result.status();
  EXPECT_EQ(row_of(*result, "error per pass").verdict, Verdict::kInconclusive);
  EXPECT_EQ(row_of(*result, "typical error").verdict, Verdict::kWorse);
  EXPECT_NEAR(row_of(*result, "typical error").log_ratio->value, std::log(1.2), 0.01);
}

TEST(GateRuns, ErrorThatTheVarianceDoesNotKnowOfIsWorse) {
  RunRecord now = run_with_variance();
  now.mixes[0].error->relmse *= 1.4;  // bias² of 0.4 of the variance
  const auto result = gate(run_json(now), run_json(run_with_variance()));
  ASSERT_TRUE(result.ok()) << result.status();
  EXPECT_EQ(row_of(*result, "error per pass").verdict, Verdict::kPass);
  EXPECT_EQ(row_of(*result, "error/variance").verdict, Verdict::kWorse);
  EXPECT_NEAR(row_of(*result, "error/variance").log_ratio->value, std::log(1.4), 1e-12);
  EXPECT_EQ(result->verdict, Verdict::kWorse);
}

TEST(GateRuns, ABiasThatTheBaselineHasTooIsNotNew) {
  RunRecord biased = run_with_variance();
  for (MixRecord& mix : biased.mixes) mix.error->relmse *= 3;
  const auto result = gate(run_json(biased), run_json(biased));
  ASSERT_TRUE(result.ok()) << result.status();
  EXPECT_EQ(result->verdict, Verdict::kPass) << gate_text(*result);
}

TEST(GateRuns, MoreCpuIsWorse) {
  RunRecord now = gated_run();
  now.summary.mixes[0].cpu_seconds *= 1.5;
  const auto result = gate(run_json(now), run_json(gated_run()));
  ASSERT_TRUE(result.ok()) << result.status();
  EXPECT_EQ(result->rows[1].verdict, Verdict::kWorse);
  GateOptions generous;
  generous.cpu_tolerance = 1;
  EXPECT_EQ(gate(run_json(now), run_json(gated_run()), generous)->verdict, Verdict::kPass);
}

TEST(CpuRatio, ScatterBetweenTilesIsDriftUnlessTheNoiseWasMeasured) {
  GateFigures now, before;
  now.passes = before.passes = 4;
  now.cpu_seconds = before.cpu_seconds = 40;
  before.tile_seconds.assign(16, 2.5);
  for (int t = 0; t < 16; ++t) now.tile_seconds.push_back(2.5 * (t % 2 == 0 ? 1.1 : 0.9));
  const Estimate known{0, 0.01, INFINITY};
  const double measured = cpu_ratio(now, before, known, true).estimate->standard_error;
  const double assumed = cpu_ratio(now, before, known, false).estimate->standard_error;
  EXPECT_NEAR(measured, std::hypot(0.01, 0.1 / 4), 0.002);
  EXPECT_NEAR(assumed, std::hypot(0.01, 0.1), 0.005);
}

TEST(GateRuns, OtherInstructionSetsAreNotJudgedByTheirTime) {
  RunRecord now = gated_run();
  now.summary.workers[0].isa = "avx512";
  now.summary.mixes[0].cpu_seconds *= 3;
  const auto result = gate(run_json(now), run_json(gated_run()));
  ASSERT_TRUE(result.ok()) << result.status();
  EXPECT_EQ(result->verdict, Verdict::kPass);
  EXPECT_FALSE(result->rows[1].verdict.has_value());
  EXPECT_THAT(result->rows[1].note, HasSubstr("instruction sets"));
}

TEST(GateRuns, WithoutBlocksTheIntervalsDecide) {
  Json now = run_json(gated_run()), before = now;
  for (Json* run : {&now, &before})
    for (Json& mix : (*run)["mixes"]) mix.erase("error_blocks");
  const auto same = gate(now, before);
  ASSERT_TRUE(same.ok()) << same.status();
  EXPECT_EQ(same->verdict, Verdict::kPass) << gate_text(*same);
  for (Json& mix : now["mixes"]) mix["relmse_ci"] = Json::array({0.3, 0.8});
  EXPECT_EQ(gate(now, before)->verdict, Verdict::kInconclusive);
}

TEST(GateRuns, TheFloorOfTheReferenceIsTakenOff) {
  RunRecord before = gated_run(), now = gated_run();
  for (RunRecord* run : {&before, &now})
    for (MixRecord& mix : run->mixes) mix.error->reference_floor = 0.4;
  for (MixRecord& mix : now.mixes) mix.error->relmse = 0.52;  // 0.12 of it above the floor, it was 0.10
  const auto result = gate(run_json(now), run_json(before));
  ASSERT_TRUE(result.ok()) << result.status();
  EXPECT_NEAR(result->rows[0].log_ratio->value, std::log(1.2), 1e-9);
  for (MixRecord& mix : now.mixes) mix.error->reference_floor = mix.error->relmse;
  EXPECT_EQ(gate(run_json(now), run_json(before))->verdict, Verdict::kInconclusive);
}

TEST(GateRuns, RefusesWhatCannotBeCompared) {
  const Json run = run_json(gated_run());
  const auto fault = [&](auto change) {
    Json before = run;
    change(before);
    return message_of(gate(run, before).status());
  };
  EXPECT_THAT(fault([](Json& b) { b["resolution"] = {64, 16}; }), HasSubstr("differ in resolution"));
  EXPECT_THAT(fault([](Json& b) { b["spec"]["bundle"] = std::string(64, 'b'); }),
              HasSubstr("the scene's files"));
  EXPECT_THAT(fault([](Json& b) { b["spec"]["crop"] = {0, 0, 8, 8}; }), HasSubstr("--crop"));
  EXPECT_THAT(fault([](Json& b) { b["spec"]["sampler"] = "independent"; }), HasSubstr("--sampler"));
  EXPECT_THAT(fault([](Json& b) { b["spec"]["camera_grid"] = 4; }), HasSubstr("--camera-grid"));
  EXPECT_THAT(fault([](Json& b) { b["mixes"][0]["mix"] = "sa:9/balance"; }),
              HasSubstr("mix sa:9/balance of the baseline is missing"));
  EXPECT_THAT(fault([](Json& b) { b["mixes"][0]["relmse"] = nullptr; }),
              HasSubstr("base.json: mix bsdf:4/balance has no error figure; render it with --reference"));
  EXPECT_THAT(fault([](Json& b) { b["schema"] = 2; }), HasSubstr("not a run.json of schema 1"));
  EXPECT_THAT(fault([](Json& b) { b["mixes"][0].erase("passes"); }), HasSubstr("base.json: "));
  EXPECT_THAT(fault([](Json& b) { b = Json::array(); }), HasSubstr("not a run.json"));
  EXPECT_THAT(fault([](Json& b) { b["partial"] = true; }), HasSubstr("interrupted"));
  EXPECT_THAT(fault([](Json& b) { b["mixes"][0]["error_blocks"]["variance"] = {1.0}; }),
              HasSubstr("error_blocks has 8 of relmse and 1 of variance"));
}

TEST(GateRuns, AMixThatIsNewIsToldAndNotJudged) {
  Json before = run_json(gated_run());
  before["mixes"].erase(1);
  const auto result = gate(run_json(gated_run()), before);
  ASSERT_TRUE(result.ok()) << result.status();
  EXPECT_THAT(gate_text(*result), HasSubstr("bsdf:1+line-sa@v:3/balance is not in the baseline"));
}

TEST(Baseline, HoldsWhatAGateNeedsAndNoPaths) {
  const Json run = run_json(gated_run());
  const auto baseline = baseline_of(run, "run.json");
  ASSERT_TRUE(baseline.ok()) << baseline.status();
  EXPECT_THAT(baseline->dump(), Not(HasSubstr("/scenes")));
  EXPECT_THAT(baseline->dump(), Not(HasSubstr("host")));
  const auto result = gate(run, *baseline);
  ASSERT_TRUE(result.ok()) << result.status();
  EXPECT_EQ(gate_text(*result), gate_text(*gate(run, run)));
}

TEST(RowsOf, BuildsAreComparedRoundByRound) {
  RoundSums now, before;
  for (int r = 0; r < 6; ++r) {
    ErrorFigures error;
    error.relmse = 0.5;
    error.blocks = {8, {0.5, 0.4, 0.6, 0.5}};
    before.add(error, 16, 1 + 0.3 * r);
    now.add(error, 32, (1 + 0.3 * r) * 2 * 1.25 * (r % 2 == 0 ? 1.01 : 0.99));  // passes of 1.25 the cost
  }
  const std::vector<GateRow> rows = rows_of("m", now, before, {}, SamplerKind::kIndependent);
  EXPECT_NEAR(rows[0].log_ratio->value, std::log(2), 1e-9) << "as much error with twice the passes";
  EXPECT_NEAR(rows[1].log_ratio->value, std::log(1.25), 0.01);
  EXPECT_LT(rows[1].log_ratio->standard_error, 0.01) << "the rounds' drift cancels";
  EXPECT_FALSE(rows_of("m", now, before, {}, SamplerKind::kSobol)[0].log_ratio.has_value());
}

TEST(RowsOf, VarianceIsOfAllRoundsOrOfNone) {
  ErrorFigures with, without;
  with.relmse = without.relmse = 0.5;
  with.blocks.relmse = without.blocks.relmse = with.blocks.variance = {0.4, 0.6};
  with.variance = 0.5;
  RoundSums all, some;
  for (int r = 0; r < 3; ++r) {
    all.add(with, 16, 1);
    some.add(r == 1 ? without : with, 16, 1);
  }
  EXPECT_EQ(all.variance, 3 * 16 * 0.5);
  EXPECT_THAT(all.block_variance, testing::ElementsAre(3 * 16 * 0.4, 3 * 16 * 0.6));
  EXPECT_FALSE(some.variance.has_value());
  EXPECT_EQ(rows_of("m", all, all, {}, SamplerKind::kSobol).size(), 3u) << "two blocks have nothing typical";
  EXPECT_EQ(rows_of("m", all, some, {}, SamplerKind::kSobol).size(), 2u);
}

TEST(NoiseFloor, IsReadFromWhatCalibratePrints) {
  std::vector<NullRun> runs = {
      {{1.00, 1.02}, {5, 5.2}, 1e-4}, {{2.04, 2.00}, {5, 4.9}, 2e-4}, {{1.05, 1.04}, {5.1, 5}, 1e-4}};
  const NoiseFigures noise = noise_of(runs);
  EXPECT_EQ(noise.cpu_between.degrees_of_freedom, 2);
  EXPECT_EQ(noise.cpu_within.degrees_of_freedom, 3);
  EXPECT_NEAR(noise.cpu_within.log_sd,
              std::sqrt((2 * std::pow(std::log(1.02), 2) + std::pow(std::log(1.05 / 1.04), 2)) / 6), 1e-12);
  EXPECT_LT(noise.cpu_between.log_sd, 0.05);
  EXPECT_GT(noise.cpu_raw.log_sd, 0.3) << "seconds double where the loop's do";
  const auto read = noise_from_json(noise_json(noise));
  ASSERT_TRUE(read.ok()) << read.status();
  EXPECT_EQ(read->cpu_log_sd, noise.cpu_between.log_sd);
  EXPECT_EQ(read->degrees_of_freedom, 2);
  EXPECT_THAT(message_of(noise_from_json(Json::object()).status()), HasSubstr("penumbra calibrate"));
  EXPECT_THAT(noise_text(noise), HasSubstr("between runs"));
}

TEST(Spread, ItsIntervalIsChiSquares) {
  // χ² of 10 degrees of freedom: quantiles 3.2470 and 20.4832.
  const ConfidenceInterval ci = Spread{1, 10}.ci();
  EXPECT_NEAR(ci.low, std::sqrt(10 / 20.4832), 0.005);
  EXPECT_NEAR(ci.high, std::sqrt(10 / 3.2470), 0.01);
}

}  // namespace
}  // namespace penumbra
