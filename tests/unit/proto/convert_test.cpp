#include "proto/convert.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "proto/status.h"

namespace penumbra {
namespace {

const Digest kDigest(64, 'a');

JobSpec full_spec() {
  JobSpec spec;
  spec.scene = "/scenes/kitchen.pbrt";
  spec.bundle = kDigest;
  for (const char* mix : {"bsdf:1+line-sa@v:3/balance", "line-area@12.5:2/smooth=0.25", "sa:4/average"})
    spec.mixes.push_back(*parse_mix(mix));
  spec.budget = CpuSecondsBudget{1.5};
  spec.sampler = SamplerKind::kSobol;
  spec.width = 640;
  spec.height = 360;
  spec.crop = {10, 20, 630, 350};
  spec.max_depth = 3;
  spec.tile = 48;
  spec.camera_grid = 4;
  spec.seed = std::numeric_limits<uint64_t>::max();
  spec.strict = true;
  spec.plan = {7, 8, 9};
  spec.reference = "ref.exr";
  spec.regions = {{"green", {1, 2, 3, 4}}};
  return spec;
}

template <class T>
void expect_round_trip(const T& value) {
  const auto back = from_proto(to_proto(value));
  ASSERT_TRUE(back.ok()) << back.status();
  EXPECT_TRUE(*back == value);
}

TEST(Convert, JobSpecsComeBack) {
  JobSpec spec = full_spec();
  expect_round_trip(spec);
  spec.budget = SppBudget{64};
  spec.plan.clear();
  expect_round_trip(spec);
  spec.budget = TargetErrorBudget{1e-3};
  spec.sampler = SamplerKind::kIndependent;
  expect_round_trip(spec);
  spec.transient = Transient{0.5, 12.25, 40};
  expect_round_trip(spec);
  spec.transient.reset();
  spec.probe = Probe{};
  expect_round_trip(spec);
  spec.probe = Probe{Probe::Kind::kIntegrand, 256, 128, 9, 7, 2, {0, 1, 0}};
  expect_round_trip(spec);
}

TEST(Convert, PlansOfAutoComeBack) {
  JobSpec spec = full_spec();
  spec.mixes.push_back(*parse_mix("auto"));
  spec.plan = {7, 8, 9, 10};
  spec.auto_plans = {{3, {*parse_mix("sa:4"), *parse_mix("bsdf:1+sa:1")}, {{1, 5, {1, 255}}, {0, 15}}}};
  expect_round_trip(spec);
  const std::vector<std::pair<std::string, std::function<void(v1::AutoPlan&)>>> faults = {
      {"auto_plans", [](v1::AutoPlan& p) { p.set_mix(2); }},
      {"candidates", [](v1::AutoPlan& p) { p.clear_candidates(); }},
      {"candidates", [](v1::AutoPlan& p) { p.set_candidates(0, "auto"); }},
      {"candidate", [](v1::AutoPlan& p) { p.mutable_tiles(0)->set_candidate(2); }},
      {"passes", [](v1::AutoPlan& p) { p.mutable_tiles(1)->set_passes(0); }},
  };
  for (const auto& [field, break_it] : faults) {
    v1::JobSpec message = to_proto(spec);
    break_it(*message.mutable_auto_plans(0));
    const auto read = from_proto(message);
    ASSERT_FALSE(read.ok()) << field;
    EXPECT_NE(message_of(read.status()).find(field), std::string::npos) << read.status();
  }
  v1::JobSpec message = to_proto(spec);
  message.clear_auto_plans();
  EXPECT_FALSE(from_proto(message).ok()) << "passes without the plan of `auto`";
}

TEST(Convert, EarlierPlansComeBackAndMustFit) {
  JobSpec spec = full_spec();
  spec.mixes.push_back(*parse_mix("auto"));
  spec.plan = {7, 8, 9, 10};
  spec.auto_plans = {{3, {*parse_mix("sa:4")}, {{0, 5}, {0, 15}}}};
  spec.earlier_plans = {{0.75, {8, 9, 10, 11}, {{6, 16}}}, {0.875, {7, 8, 9, 9}, {{5, 14}}}};
  expect_round_trip(spec);
  const std::vector<std::function<void(v1::JobSpec&)>> faults = {
      [](v1::JobSpec& s) { s.mutable_earlier_plans(1)->set_until(0.75); },
      [](v1::JobSpec& s) { s.mutable_earlier_plans(1)->set_until(1); },
      [](v1::JobSpec& s) { s.mutable_earlier_plans(0)->set_until(std::nan("")); },
      [](v1::JobSpec& s) { s.mutable_earlier_plans(0)->add_passes(1); },
      [](v1::JobSpec& s) { s.mutable_earlier_plans(0)->clear_autos(); },
      [](v1::JobSpec& s) { s.mutable_earlier_plans(0)->mutable_autos(0)->set_passes(0, 0); },
      [](v1::JobSpec& s) {
        s.clear_plan();
        s.clear_auto_plans();
      },
  };
  for (size_t i = 0; i < faults.size(); ++i) {
    v1::JobSpec message = to_proto(spec);
    faults[i](message);
    const auto read = from_proto(message);
    ASSERT_FALSE(read.ok()) << i;
    EXPECT_NE(message_of(read.status()).find("earlier_plans"), std::string::npos) << read.status();
  }
}

TEST(Convert, TasksCostsAndReportsComeBack) {
  TileTask repeats{3, TaskKind::kRun, {0, 0, 64, 32}, {{0, 8}, {2, 2}}, 4, 99};
  repeats.repilot = {{1, 2}, {0, 0}};
  expect_round_trip(repeats);
  v1::TileTask one_short = to_proto(repeats);
  one_short.mutable_repilot()->RemoveLast();
  EXPECT_FALSE(from_proto(one_short).ok());
  MixCost repeated;
  repeated.repilot_passes = 3;
  repeated.repilot_seconds = 0.25;
  expect_round_trip(repeated);
  expect_round_trip(TileTask{3, TaskKind::kPilot, {0, 0, 64, 32}, {{0, 8}, {2, 2}}, 4, 99, 0.5});
  expect_round_trip(TileTask{3,
                             TaskKind::kPilot,
                             {0, 0, 64, 32},
                             {{0, 0}},
                             4,
                             99,
                             0.5,
                             {{0, *parse_mix("sa:4"), 2}, {0, *parse_mix("bsdf:1+line-sa@v:1/free"), 1}},
                             9});
  expect_round_trip(MixCost{8, 0.25, 1000, 20, 1, 3.5, {7, 0.125}, 64, 7.25, 40, 1e9, 0.125});
  expect_round_trip(LoadReport{0.1, 0.2, {{"lens", "a.pbrt:3:1: aperture"}}, {"no texture"}});
  expect_round_trip(WorkerInfo{"uuid", "host", "avx2", 4});
}

TEST(Convert, ReportsWhoseSumsWouldNotBeFiniteAreRefused) {
  const std::vector<std::pair<std::string, std::function<void(v1::MixCost&)>>> faults = {
      {"cpu_seconds", [](v1::MixCost& c) { c.set_cpu_seconds(1e308); }},
      {"work", [](v1::MixCost& c) { c.set_work(1e101); }},
      {"calibration", [](v1::MixCost& c) { c.mutable_calibration()->set_seconds(1e308); }},
      {"relative_variance_squares", [](v1::MixCost& c) { c.set_relative_variance_squares(1e201); }},
      {"repilot_seconds", [](v1::MixCost& c) { c.set_repilot_seconds(-1); }},
  };
  for (const auto& [field, break_it] : faults) {
    v1::MixCost message = to_proto(MixCost{8, 0.25, 1000, 20, 1, 3.5, {7, 0.125}, 64, 1e190, 40, 1e9, 0.125});
    ASSERT_TRUE(from_proto(message).ok());
    break_it(message);
    const auto read = from_proto(message);
    ASSERT_FALSE(read.ok()) << field;
    EXPECT_NE(message_of(read.status()).find(field), std::string::npos) << read.status();
  }
}

TEST(Convert, SummariesComeBack) {
  RunSummary summary;
  summary.spec = full_spec();
  summary.status.job = "j1";
  summary.status.state = JobState::kFailed;
  summary.status.failure = FailureKind::kBadInput;
  summary.status.message = "a.pbrt:1:1: no";
  summary.status.plan = {7, 8, 9};
  summary.status.fraction = 0.5;
  summary.status.faults = {1, 2, 3, 4, 5, 6, 7};
  summary.status.terms = {"ada", -7, {"shot=12"}, {"j0"}};
  for (const Mix& mix : summary.spec.mixes)
    summary.mixes.push_back(
        {mix, 7, 6, 1.5, 10, 20, 1, 0.1, {"sa for line-sa@v"}, {{1, 0.2}, {6, 1.5}}, {7, 0.125}});
  summary.tiles = {{{0, 0, 8, 8}, 2, 6, 0.5, "uuid", {3, 0.5}}};
  summary.workers = {{"uuid", "host", "avx512", 2}};
  summary.worker_cpu_seconds = 3;
  expect_round_trip(summary);
}

TEST(Convert, BothHalvesOfASyncComeBack) {
  WorkerState state;
  state.version = "1";
  state.worker = {"uuid", "host", "avx2", 4};
  state.name = "cache#0";
  state.held = {{{"j1", 2, 3}, true}};
  const LeaseId done{"j1", 4, 1}, pilot{"j1", 5, 1}, bad{"j1", 6, 1}, returned{"j1", 7, 1};
  state.completed.push_back({done, kDigest, "its bytes", {MixCost{8, 0.25, 1000, 20, 0, 0}}, {}});
  state.completed.push_back({pilot, "", {}, {}, {}});
  state.failed.push_back({bad, TaskFailure::kBadInput, "why"});
  state.failed.push_back({returned, TaskFailure::kReturned, ""});
  state.failed.push_back({{"j1", 8, 1}, TaskFailure::kLostInput, "gone"});
  state.loaded = {{"j1", {0.1, 0.2, {}, {"w"}}, {{0, "sa"}}}};
  state.wanted = 8;
  state.known_jobs = {"j1"};
  state.process_cpu_seconds = 12;
  state.wait_milliseconds = 4000;
  state.draining = true;
  expect_round_trip(state);

  DesiredState desired;
  desired.leases.push_back({done, std::nullopt});
  desired.leases.push_back({pilot, TileTask{9, TaskKind::kRun, {0, 0, 4, 4}, {{0, 8}}, 4, 1, 0}});
  desired.jobs = {{"j1", full_spec()}};
  desired.acknowledged = {{"j1", 4, 1}};
  desired.acknowledged_loads = {"j1"};
  desired.finished_jobs = {"j0"};
  expect_round_trip(desired);
}

TEST(Convert, ValuesOutOfRangeAreRefusedByName) {
  const std::vector<std::pair<std::string, std::function<void(v1::JobSpec&)>>> faults = {
      {"probe.kind", [](v1::JobSpec& s) { s.mutable_probe(); }},
      {"probe.x",
       [](v1::JobSpec& s) {
         s.mutable_probe()->set_kind(v1::Probe::KIND_INTEGRAND);
         s.mutable_probe()->set_camera_width(4);
         s.mutable_probe()->set_camera_height(4);
         s.mutable_probe()->set_x(4);
       }},
      {"width", [](v1::JobSpec& s) { s.set_width(0); }},
      {"height", [](v1::JobSpec& s) { s.set_height(65537); }},
      {"crop", [](v1::JobSpec& s) { s.mutable_crop()->set_x1(641); }},
      {"crop", [](v1::JobSpec& s) { s.mutable_crop()->set_x1(10); }},
      {"rect", [](v1::JobSpec& s) { s.mutable_crop()->set_x0(-1); }},
      {"tile", [](v1::JobSpec& s) { s.set_tile(0); }},
      {"transient", [](v1::JobSpec& s) { s.mutable_transient()->set_bins(1); }},
      {"transient",
       [](v1::JobSpec& s) {
         s.mutable_transient()->set_t1(1);
         s.mutable_transient()->set_bins(1025);
       }},
      {"transient",
       [](v1::JobSpec& s) {
         s.mutable_transient()->set_t1(std::numeric_limits<double>::infinity());
         s.mutable_transient()->set_bins(1);
       }},
      {"transient",
       [](v1::JobSpec& s) {
         s.mutable_transient()->set_t0(1);
         s.mutable_transient()->set_t1(1.000001);
         s.mutable_transient()->set_bins(16);
       }},
      {"camera_grid", [](v1::JobSpec& s) { s.set_camera_grid(-1); }},
      {"max_depth", [](v1::JobSpec& s) { s.set_max_depth(0); }},
      {"plan", [](v1::JobSpec& s) { s.add_plan(1); }},
      {"plan", [](v1::JobSpec& s) { s.set_plan(0, -1); }},
      {"mixes", [](v1::JobSpec& s) { s.clear_mixes(); }},
      {"nonsense", [](v1::JobSpec& s) { s.set_mixes(0, "nonsense:1"); }},
      {"sampler", [](v1::JobSpec& s) { s.clear_sampler(); }},
      {"budget", [](v1::JobSpec& s) { s.clear_budget(); }},
      {"cpu_seconds", [](v1::JobSpec& s) { s.mutable_budget()->set_cpu_seconds(std::nan("")); }},
      {"cpu_seconds", [](v1::JobSpec& s) { s.mutable_budget()->set_cpu_seconds(1e308); }},
      {"cpu_seconds", [](v1::JobSpec& s) { s.mutable_budget()->set_cpu_seconds(1e-300); }},
      {"spp", [](v1::JobSpec& s) { s.mutable_budget()->set_spp(0); }},
      {"target_error", [](v1::JobSpec& s) { s.mutable_budget()->set_target_error(-1); }},
      {"target_error", [](v1::JobSpec& s) { s.mutable_budget()->set_target_error(1e200); }},
      {"bundle", [](v1::JobSpec& s) { s.set_bundle("../../etc/passwd"); }},
      {"scene", [](v1::JobSpec& s) { s.set_scene(std::string(1 << 20, 'x')); }},
  };
  for (const auto& [field, break_it] : faults) {
    v1::JobSpec message = to_proto(full_spec());
    break_it(message);
    const auto spec = from_proto(message);
    ASSERT_FALSE(spec.ok()) << field;
    EXPECT_TRUE(absl::IsInvalidArgument(spec.status()));
    EXPECT_NE(message_of(spec.status()).find(field), std::string::npos) << spec.status();
  }
}

TEST(Convert, ResultsTooLargeToComeAlongAreRefused) {
  WorkerState state;
  state.name = "cache#0";
  state.worker = {"uuid", "host", "avx2", 4};
  state.completed.push_back({{"j1", 4, 1}, kDigest, std::string(kMostBytesAlong, 'x'), {}, {}});
  EXPECT_TRUE(from_proto(to_proto(state)).ok());
  state.completed.front().bytes += 'x';
  EXPECT_EQ(from_proto(to_proto(state)).status().code(), absl::StatusCode::kInvalidArgument);
  state.completed.front() = {{"j1", 4, 1}, "", "x", {}, {}};
  EXPECT_EQ(from_proto(to_proto(state)).status().code(), absl::StatusCode::kInvalidArgument);
}

TEST(Convert, AnotherProtocolIsRefused) {
  v1::SyncRequest request;
  request.set_protocol(kSyncProtocol + 1);
  EXPECT_TRUE(absl::IsFailedPrecondition(from_proto(request).status()));
}

TEST(Convert, NonFiniteCostsAreRefused) {
  v1::MixCost cost = to_proto(MixCost{1, 1, 0, 0, 0, 0});
  cost.set_cpu_seconds(std::numeric_limits<double>::infinity());
  EXPECT_FALSE(from_proto(cost).ok());
}

}  // namespace
}  // namespace penumbra
