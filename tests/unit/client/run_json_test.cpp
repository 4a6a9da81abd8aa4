#include "client/run_json.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <limits>

#include "proto/status.h"
#include "sample_run.h"

namespace penumbra {
namespace {

using testing::HasSubstr;

TEST(RunJson, HasTheInterfacesKeys) {
  const Json json = run_json(sample_run());
  for (const char* key : {"schema", "version", "scene", "resolution", "seed", "budget", "needs", "load",
                          "mixes", "tiles", "workers", "wall_seconds", "retries", "scheduler"})
    EXPECT_TRUE(json.contains(key)) << key;
  const Json& mix = json["mixes"][1];
  for (const char* key :
       {"mix", "image", "passes", "cpu_seconds", "budget_ratio", "rays", "line_queries", "ray_seconds",
        "non_finite", "relmse", "relmse_ci", "mse", "reference_floor", "regions", "timeline"})
    EXPECT_TRUE(mix.contains(key)) << key;
  EXPECT_EQ(json["schema"], 1);
  EXPECT_EQ(json["resolution"], Json::array({32, 16}));
  EXPECT_EQ(json["seed"].get<uint64_t>(), 18446744073709551615u);
  EXPECT_EQ(json["budget"], (Json{{"cpu_seconds", 10.0}}));
  EXPECT_EQ(json["needs"][0]["effect"], "textures");
  EXPECT_EQ(json["retries"], 2);
  EXPECT_EQ(json["scheduler"]["cpu_seconds"], 0.125);
  EXPECT_EQ(json["tiles"][1]["mix"], 1);
  EXPECT_EQ(json["workers"][0]["isa"], "avx2");
  EXPECT_EQ(mix["mix"], "bsdf:1+line-sa@v:3/balance");
  EXPECT_EQ(mix["image"], "bsdf-1+line-sa-v-3_balance.exr");
  EXPECT_EQ(mix["budget_ratio"], 0.95);
  EXPECT_EQ(mix["regions"]["left"]["relmse_ci"], Json::array({0.4, 0.6}));
  const Json& first = mix["timeline"][0];
  EXPECT_EQ(first["cpu_seconds"], 2.5);
  EXPECT_EQ(first["passes"], 16);
  EXPECT_EQ(first["relmse"], 2.0);
  EXPECT_EQ(first["relmse_ci"], Json::array({1.5, 2.5}));
  EXPECT_EQ(first["estimated_relmse"], 1.75);
  EXPECT_EQ(mix["estimated_relmse"], 0.45);
  EXPECT_EQ(mix["timeline"][1]["estimated_relmse"], 0.45) << "the last point is the final image";
  EXPECT_EQ(mix["timeline"][1]["estimated_relmse_ci"], Json::array({0.35, 0.55}));
}

TEST(RunJson, ATimelineHasNoPointWithoutNewPasses) {
  RunRecord run = sample_run();
  std::vector<Checkpoint>& points = run.summary.mixes[1].checkpoints;
  ASSERT_EQ(points.size(), 2u);
  points.insert(points.begin(), points[0]);
  points.insert(points.begin(), points[0]);
  points[0].passes = 0;
  run.mixes[1].checkpoints.clear();
  const Json timeline = run_json(run)["mixes"][1]["timeline"];
  ASSERT_EQ(timeline.size(), 2u);
  EXPECT_EQ(timeline[0]["passes"], 16);
  EXPECT_GT(timeline[1]["passes"], 16);
}

TEST(RunJson, WhatDoesNotApplyIsNull) {
  RunRecord run = sample_run();
  run.summary.spec.budget = SppBudget{64};
  for (MixRecord& mix : run.mixes) mix = {mix.label, mix.image, {}, {}, {}};
  const Json json = run_json(run);
  const Json& mix = json["mixes"][0];
  for (const char* key : {"budget_ratio", "ray_seconds", "relmse", "relmse_ci", "mse", "reference_floor"})
    EXPECT_TRUE(mix[key].is_null()) << key;
  for (const char* key : {"relmse", "relmse_ci", "estimated_relmse", "estimated_relmse_ci"})
    EXPECT_TRUE(mix["timeline"][1][key].is_null()) << key;
  EXPECT_EQ(json["budget"], (Json{{"spp", 64}}));
}

TEST(RunJson, ReplaysTheSameJobWithItsPlan) {
  RunRecord run = sample_run();
  const auto spec = replay_spec(Json::parse(json_text(run_json(run))));
  ASSERT_TRUE(spec.ok()) << message_of(spec.status());
  JobSpec expected = run.summary.spec;
  expected.plan = {64, 64};
  EXPECT_EQ(*spec, expected);
}

TEST(RunJson, PlansOfAutoAreToldAndReplayed) {
  RunRecord run = sample_run();
  JobSpec& spec = run.summary.spec;
  spec.mixes[1] = *parse_mix("auto");
  spec.tile = 16;
  run.summary.mixes[1].mix = spec.mixes[1];
  run.summary.auto_plans = {
      {1, {*parse_mix("sa:4"), *parse_mix("bsdf:2+sa:2")}, {{1, 20}, {0, 108, {255, 9, 70, 8}}}}};
  run.summary.earlier_plans = {{0.75, {10, 60}, {{18, 102}}}};
  const Json json = Json::parse(json_text(run_json(run)));
  const Json& plan = json["auto_plans"][0];
  EXPECT_EQ(plan["mix"], 1);
  EXPECT_EQ(plan["candidates"], (Json{"sa:4/balance", "bsdf:2+sa:2/balance"}));
  EXPECT_EQ(
      plan["tiles"][0],
      (Json{{"rect", {0, 0, 16, 16}}, {"candidate", 1}, {"mix", "bsdf:2+sa:2/balance"}, {"passes", 20}}));
  const auto again = replay_spec(json);
  ASSERT_TRUE(again.ok()) << message_of(again.status());
  EXPECT_EQ(again->auto_plans, run.summary.auto_plans);
  EXPECT_EQ(again->earlier_plans, run.summary.earlier_plans);
  // A replay's own run.json replays too.
  const auto third = job_from_json(to_json(*again));
  ASSERT_TRUE(third.ok()) << message_of(third.status());
  EXPECT_EQ(*third, *again);

  const auto fault = [&](auto break_it) {
    Json broken = json;
    break_it(broken["auto_plans"]);
    const auto spec_of_it = replay_spec(broken);
    EXPECT_EQ(spec_of_it.status().code(), absl::StatusCode::kInvalidArgument);
    return message_of(spec_of_it.status());
  };
  EXPECT_THAT(fault([](Json& plans) { plans = Json::array(); }), HasSubstr("before `auto` was planned"));
  EXPECT_THAT(fault([](Json& plans) { plans[0]["tiles"].erase(1); }), HasSubstr("1 tiles"));
  EXPECT_THAT(fault([](Json& plans) { plans[0]["tiles"][0]["candidate"] = 2; }),
              HasSubstr("candidate 2 of 2"));
  EXPECT_THAT(fault([](Json& plans) { plans[0]["tiles"][0]["passes"] = 0; }), HasSubstr("0 passes"));
  EXPECT_THAT(fault([](Json& plans) { plans[0]["tiles"][1]["shares"][0] = 256; }),
              HasSubstr("a share of 256"));
  EXPECT_THAT(fault([](Json& plans) { plans[0]["tiles"][1]["shares"].erase(1); }), HasSubstr("3 shares"));
  EXPECT_THAT(fault([](Json& plans) { plans[0]["mix"] = 0; }), HasSubstr("auto_plans"));
  EXPECT_THAT(fault([](Json& plans) { plans[0].erase("candidates"); }), HasSubstr("candidates"));
  Json broken = json;
  broken["earlier_plans"][0]["autos"][0].erase(1);
  EXPECT_THAT(message_of(replay_spec(broken).status()), HasSubstr("earlier_plans: 1 tiles"));
  broken = json;
  broken["earlier_plans"][0].erase("until");
  EXPECT_THAT(message_of(replay_spec(broken).status()), HasSubstr("earlier_plans"));
}

TEST(RunJson, WhatCannotBeReplayedIsSaid) {
  EXPECT_FALSE(replay_spec(Json::object()).ok());
  EXPECT_FALSE(replay_spec(Json::array()).ok());
  Json json = run_json(sample_run());
  json["plan"] = {64, 0};
  EXPECT_THAT(message_of(replay_spec(json).status()), HasSubstr("before it was planned"));
  json["plan"] = {64};
  EXPECT_THAT(message_of(replay_spec(json).status()), HasSubstr("1 counts for 2 mixes"));
  json = run_json(sample_run());
  json["spec"]["crop"] = {0, 0, 33, 16};
  EXPECT_FALSE(replay_spec(json).ok());
  json["spec"]["width"] = "wide";
  EXPECT_EQ(replay_spec(json).status().code(), absl::StatusCode::kInvalidArgument);
}

TEST(RunJson, NumbersOutOfRangeAreRefused) {
  const auto refused = [](const char* key, const Json& value) {
    Json json = run_json(sample_run());
    json["spec"][key] = value;
    EXPECT_EQ(replay_spec(json).status().code(), absl::StatusCode::kInvalidArgument) << key << value;
  };
  refused("width", 1e300);
  refused("width", int64_t{1} << 32);
  refused("max_depth", 1.5);
  refused("seed", -1);
  refused("plan", Json{1e300, 1});
  refused("plan", 3);
  refused("crop", Json{0, 0, 16});
  refused("crop", Json{int64_t{std::numeric_limits<int>::min()}, 0, std::numeric_limits<int>::max(), 16});
  refused("crop", Json{8, 8, 4, 4});  // of a positive area, all the same
  refused("tile", kMostTile + 1);
  Json large = run_json(sample_run());
  for (const char* key : {"width", "height"}) large["spec"][key] = 1 << 30;
  large["spec"]["crop"] = Json{0, 0, 1 << 30, 1 << 30};
  large["spec"]["tile"] = 1;  // more tiles than could be listed
  EXPECT_EQ(replay_spec(large).status().code(), absl::StatusCode::kInvalidArgument);
}

TEST(ReadJson, NamesTheFile) {
  const auto path = std::filesystem::path(testing::TempDir()) / "penumbra_broken.json";
  std::ofstream(path) << "{\"a\": [1, 2";
  EXPECT_THAT(message_of(read_json(path).status()), HasSubstr("penumbra_broken.json: not JSON"));
  std::filesystem::remove(path);
  EXPECT_EQ(read_json(path).status().code(), absl::StatusCode::kNotFound);
}

}  // namespace
}  // namespace penumbra
