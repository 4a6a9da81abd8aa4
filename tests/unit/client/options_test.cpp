#include "client/options.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <CLI/CLI.hpp>

#include "proto/status.h"

namespace penumbra {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

SceneDefaults small_scene() {
  SceneDefaults scene;
  scene.width = 64;
  scene.height = 48;
  scene.passes = 16;
  return scene;
}

JobOptions plain() {
  JobOptions options;
  options.scene = "s.pbrt";
  return options;
}

std::string fault(const JobOptions& options) {
  const auto job = make_job(options, small_scene());
  EXPECT_FALSE(job.ok());
  EXPECT_EQ(job.status().code(), absl::StatusCode::kInvalidArgument);
  return message_of(job.status());
}

TEST(MakeJob, DefaultsAreTheScenes) {
  const auto job = make_job(plain(), small_scene());
  ASSERT_TRUE(job.ok()) << message_of(job.status());
  EXPECT_EQ(job->budget, Budget(SppBudget{16}));
  EXPECT_EQ(job->width, 64);
  EXPECT_EQ(job->crop, (PixelRect{0, 0, 64, 48}));
  EXPECT_EQ(job->sampler, SamplerKind::kStratified);
  EXPECT_EQ(job->seed, 0u);
  ASSERT_EQ(job->mixes.size(), 1u);
  EXPECT_EQ(label(job->mixes[0]), "auto");
  EXPECT_EQ(job->tile, 32);
  EXPECT_TRUE(job->scene.starts_with('/'));
}

TEST(MakeJob, TheScenesMixComesBeforeTheDefault) {
  SceneDefaults scene = small_scene();
  scene.mix = *parse_mix("bsdf:2+line-sa@v:2");
  EXPECT_EQ(label(make_job(plain(), scene)->mixes[0]), "bsdf:2+line-sa@v:2/balance");
  JobOptions options = plain();
  options.mixes = {"sa:4"};
  EXPECT_EQ(label(make_job(options, scene)->mixes[0]), "sa:4/balance");
  EXPECT_EQ(make_job(options, scene)->tile, 64);
}

TEST(MakeJob, OptionsOverride) {
  JobOptions o = plain();
  o.mixes = {"bsdf:4", "bsdf:4"};
  o.budget = "2m";
  o.resolution = "20x10";
  o.crop = "1,2,10,10";
  o.regions = {"a=1,2,5,5", "b=5,5,10,10"};
  o.sampler = "sobol";
  o.max_depth = "3";
  o.tile = "16";
  o.camera_grid = "4";
  o.transient = "1.5,20,64";
  o.seed = "7";
  o.reference = "r.exr";
  const auto job = make_job(o, small_scene());
  ASSERT_TRUE(job.ok()) << message_of(job.status());
  EXPECT_EQ(job->mixes.size(), 2u);
  EXPECT_EQ(job->budget, Budget(CpuSecondsBudget{120}));
  EXPECT_EQ(job->width, 20);
  EXPECT_EQ(job->crop, (PixelRect{1, 2, 10, 10}));
  EXPECT_EQ(job->regions[1], (Region{"b", {5, 5, 10, 10}}));
  EXPECT_EQ(job->sampler, SamplerKind::kSobol);
  EXPECT_EQ(job->max_depth, 3);
  EXPECT_EQ(job->camera_grid, 4);
  EXPECT_EQ(job->tile, 16);
  EXPECT_EQ(job->transient, (Transient{1.5, 20, 64}));
  EXPECT_EQ(job->seed, 7u);
  EXPECT_TRUE(job->reference.ends_with("/r.exr"));
}

TEST(MakeJob, EveryFaultNamesItsFlag) {
  const auto with = [](std::string JobOptions::*field, const char* value) {
    JobOptions o = plain();
    o.*field = value;
    return fault(o);
  };
  EXPECT_THAT(with(&JobOptions::budget, "0s"), StartsWith("--budget: "));
  EXPECT_THAT(with(&JobOptions::budget, "-1s"), StartsWith("--budget: "));
  EXPECT_THAT(with(&JobOptions::passes, "0"), StartsWith("--spp: "));
  EXPECT_THAT(with(&JobOptions::target_error, "0"), StartsWith("--target-error: "));
  EXPECT_THAT(with(&JobOptions::resolution, "0x5"), StartsWith("--resolution: "));
  EXPECT_THAT(with(&JobOptions::crop, "0,0,65,48"), StartsWith("--crop: "));
  EXPECT_THAT(with(&JobOptions::crop, "5,5"), StartsWith("--crop: "));
  EXPECT_THAT(with(&JobOptions::camera_grid, "0"), StartsWith("--camera-grid: "));
  for (const char* bins : {"1,2", "1,2,3,4", "2,1,4", "-1,2,4", "0,1,0", "0,1,1025", "0,inf,4", "0,nan,4",
                           "nan,1,4", "1,1.000001,100", "0,1e39,4", "0,1e-38,1", "0,1e-300,4"})
    EXPECT_THAT(with(&JobOptions::transient, bins), StartsWith("--transient: ")) << bins;
  EXPECT_THAT(with(&JobOptions::max_depth, "0"), StartsWith("--max-depth: "));
  EXPECT_THAT(with(&JobOptions::tile, "5000"), StartsWith("--tile: "));
  EXPECT_THAT(with(&JobOptions::seed, "-1"), StartsWith("--seed: "));
  EXPECT_THAT(with(&JobOptions::sampler, "halton"), StartsWith("--sampler: "));
}

TEST(JobOptions, AnEmptyValueIsNoValue) {
  for (const char* flag : {"--transient", "--budget", "--mix", "--region", "--reference", "--crop"}) {
    CLI::App app;
    JobOptions o;
    add_job_options(app, o);
    try {
      app.parse(std::vector<std::string>{"", flag, "s.pbrt"});  // CLI11 takes them from the back
      ADD_FAILURE() << flag << " '' was taken";
    } catch (const CLI::ParseError& error) {
      EXPECT_THAT(error.what(), HasSubstr(flag));
    }
  }
}

TEST(MakeJob, BinsThatATileOrThePictureCannotHoldAreRefused) {
  JobOptions o = plain();
  o.resolution = "4096x4096";
  o.transient = "0,1,8";
  EXPECT_THAT(fault(o), testing::AllOf(StartsWith("--transient: "), testing::HasSubstr("pixels")));
  o.resolution = "256x256";
  o.transient = "0,1,1024";
  o.tile = "128";
  EXPECT_THAT(fault(o), testing::AllOf(StartsWith("--transient: "), testing::HasSubstr("--tile")));
  o.tile = "32";
  EXPECT_TRUE(make_job(o, small_scene()).ok());
}

TEST(MakeJob, MixesAreChecked) {
  const auto with = [](const char* mix) {
    JobOptions o = plain();
    o.mixes = {mix};
    return fault(o);
  };
  EXPECT_THAT(with("bsdv:1"), HasSubstr("bsdv"));
  EXPECT_THAT(with("bsdf:-1"), StartsWith("--mix: "));
  EXPECT_THAT(with("bsdf:0"), StartsWith("--mix: "));
  EXPECT_THAT(with("auto:2"), StartsWith("--mix: "));
  EXPECT_THAT(with("auto+sa"), StartsWith("--mix: "));
  EXPECT_THAT(with("bsdf:1/smooth=0.1"), StartsWith("--mix: "));
}

TEST(MakeJob, RegionsLieInTheCropAndHaveDistinctNames) {
  JobOptions o = plain();
  o.regions = {"a=0,0,65,5"};
  EXPECT_THAT(fault(o), StartsWith("--region: "));
  o.regions = {"a=0,0,5,5", "a=1,1,2,2"};
  EXPECT_THAT(fault(o), HasSubstr("named twice"));
}

TEST(MakeJob, OneBudgetOnly) {
  JobOptions o = plain();
  o.budget = "1s";
  o.passes = "4";
  EXPECT_THAT(fault(o), HasSubstr("exclude one another"));
}

TEST(ClusterSize, SharesTheCores) {
  EXPECT_EQ(cluster_size({}, 8)->workers, 2);
  EXPECT_EQ(cluster_size({}, 8)->threads, 4);
  EXPECT_EQ(cluster_size({}, 1)->threads, 1);
  EXPECT_EQ(cluster_size({"3", ""}, 8)->threads, 2);
  EXPECT_EQ(cluster_size({"1", "5"}, 8)->threads, 5);
  EXPECT_THAT(message_of(cluster_size({"0", ""}, 8).status()), StartsWith("--workers: "));
  EXPECT_THAT(message_of(cluster_size({"", "-2"}, 8).status()), StartsWith("--threads: "));
}

TEST(DefaultFolder, IsNamedByTheScene) {
  EXPECT_EQ(default_folder("/a/b/kitchen.pbrt"), "penumbra-out/kitchen");
}

TEST(CommandLine, TakesRepeatedMixesBesideTheScene) {
  CLI::App app;
  JobOptions o;
  add_job_options(app, o);
  app.parse("--mix bsdf:4 --mix sa:4 s.pbrt --region a=1,2,3,4", false);
  EXPECT_EQ(o.mixes, (std::vector<std::string>{"bsdf:4", "sa:4"}));
  EXPECT_EQ(o.scene, "s.pbrt");
  EXPECT_EQ(o.regions, std::vector<std::string>{"a=1,2,3,4"});
}

/// What CLI11 says of these words, or "".
std::string said_of(const std::string& words, bool from_environment) {
  CLI::App app;
  ServerOptions options;
  add_server_options(app, options, from_environment);
  try {
    app.parse(words);
    return "";
  } catch (const CLI::ParseError& fault) {
    return fault.what();
  }
}

TEST(ServerOptions, CertificatesAndTokensNeedAServerWhereALocalClusterWouldStandInForIt) {
  for (const std::string flag : {"--tls-cert", "--tls-key", "--tls-ca", "--token-file"}) {
    EXPECT_THAT(said_of(flag + " file", false), HasSubstr(flag));
    EXPECT_EQ(said_of("--server host:7400 " + flag + " file", false), "");
    EXPECT_EQ(said_of(flag + " file", true), "") << "PENUMBRA_SERVER may name it";
  }
}

TEST(JobOptions, ThoseThatWereTypedAreFound) {
  const std::vector<std::string> flags = job_flags();
  EXPECT_THAT(flags, testing::IsSupersetOf({"--mix", "--camera-grid", "--transient", "--seed", "--strict"}));
  EXPECT_THAT(flags, testing::Not(testing::Contains("scene")));
  CLI::App app;
  JobOptions options;
  add_job_options(app, options);
  app.parse("s.pbrt");
  EXPECT_EQ(first_given(app, flags), "");
  for (const std::string words : {"--camera-grid 4", "--transient 0,1,4", "--strict"}) {
    app.parse("s.pbrt " + words);
    EXPECT_EQ(first_given(app, flags), words.substr(0, words.find(' ')));
  }
}

}  // namespace
}  // namespace penumbra
