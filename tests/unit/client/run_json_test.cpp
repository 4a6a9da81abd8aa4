#include "client/run_json.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

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

TEST(ReadJson, NamesTheFile) {
  const auto path = std::filesystem::path(testing::TempDir()) / "penumbra_broken.json";
  std::ofstream(path) << "{\"a\": [1, 2";
  EXPECT_THAT(message_of(read_json(path).status()), HasSubstr("penumbra_broken.json: not JSON"));
  std::filesystem::remove(path);
  EXPECT_EQ(read_json(path).status().code(), absl::StatusCode::kNotFound);
}

}  // namespace
}  // namespace penumbra
