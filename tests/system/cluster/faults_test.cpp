// Processes die, messages come late or twice, input is bad: the picture is that of the undisturbed run, or
// the job fails with its reason.
#include <gtest/gtest.h>
#include <signal.h>

#include <chrono>
#include <thread>

#include "proto/blocks.h"
#include "proto/convert.h"
#include "proto/tiles.h"
#include "tests/system/cluster/calm.h"

namespace penumbra {
namespace {

TEST(Faults, AnyNumberOfWorkersAndThreadsMakeTheSamePicture) {
  Cluster cluster(test_name());
  cluster.start_server();
  cluster.start_worker(2);
  cluster.start_worker(3, "another-cache");
  const JobId job = cluster.submit(cluster.spec(cluster.upload_scene("1")));
  expect_calm(cluster, job);
}

TEST(Faults, AKilledWorkerCostsItsLeasesOnly) {
  Cluster cluster(test_name());
  cluster.start_server();
  Process& victim = cluster.start_worker(2);
  const JobId job = cluster.submit(cluster.spec(cluster.upload_scene("4")));
  for (uint64_t done : {3, 8}) {
    cluster.wait_until(job, 30,
                       [&](const JobStatus& s) { return s.tasks_done >= done && s.tasks_leased > 0; });
    (done == 3 ? victim : cluster.worker(1)).kill_hard();
    cluster.start_worker(2);
  }
  expect_calm(cluster, job);
  EXPECT_GE(cluster.status(job).retries, 1u);
}

TEST(Faults, AKilledServerGoesOnWhereItWas) {
  Cluster cluster(test_name());
  cluster.start_server();
  cluster.start_worker(2);
  const JobId job = cluster.submit(cluster.spec(cluster.upload_scene("4")));
  for (int kill = 0; kill < 2; ++kill) {
    const uint64_t before =
        cluster.wait_until(job, 30, [&](const JobStatus& s) { return s.tasks_done > 4u * (kill + 1); })
            .tasks_done;
    cluster.server().kill_hard();
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    cluster.start_server();
    EXPECT_GE(cluster.status(job).tasks_done, before) << "an accepted result was lost";
  }
  expect_calm(cluster, job);
}

TEST(Faults, ServerAndWorkerDieTogether) {
  Cluster cluster(test_name());
  cluster.start_server();
  cluster.start_worker(2);
  const JobId job = cluster.submit(cluster.spec(cluster.upload_scene("4")));
  cluster.wait_until(job, 30, [](const JobStatus& s) { return s.tasks_done > 3; });
  cluster.server().kill_hard();
  cluster.worker(0).kill_hard();
  cluster.start_server();
  cluster.start_worker(1);
  expect_calm(cluster, job);
}

TEST(Faults, AStoppedWorkerHandsBackWithinSeconds) {
  Cluster cluster(test_name());
  cluster.start_server();
  Process& leaving = cluster.start_worker(2);
  // 32 passes of two mixes at 100 ms: no task ends within the grace.
  const JobId job = cluster.submit(cluster.spec(cluster.upload_scene("100")));
  cluster.wait_until(job, 30, [](const JobStatus& s) { return s.tasks_leased >= 2; });
  const double start = steady_seconds();
  leaving.signal(SIGTERM);
  EXPECT_EQ(leaving.wait(10), 0);
  EXPECT_LT(steady_seconds() - start, patience() * 5.5);
  EXPECT_EQ(cluster.status(job).tasks_leased, 0u);
}

TEST(Faults, CancellingFreesTheWorkerWithinASecond) {
  Cluster cluster(test_name());
  cluster.start_server();
  cluster.start_worker(1);
  const JobId slow = cluster.submit(cluster.spec(cluster.upload_scene("100")));
  cluster.wait_until(slow, 30, [](const JobStatus& s) { return s.tasks_leased >= 1; });
  v1::JobRequest request;
  request.set_job(slow);
  grpc::ClientContext context;
  v1::JobStatus response;
  ASSERT_TRUE(cluster.render().Cancel(&context, request, &response).ok());
  EXPECT_EQ(response.state(), v1::JOB_STATE_CANCELLED);
  const double start = steady_seconds();
  const JobId next = cluster.submit(cluster.spec(cluster.upload_scene("0")));
  cluster.wait_until(next, 30, [](const JobStatus& s) { return s.tasks_done > 0; });
  EXPECT_LT(steady_seconds() - start, patience() * 1.5);
}

TEST(Faults, ABadSceneFailsTheJobWithItsPlace) {
  Cluster cluster(test_name());
  cluster.start_server();
  cluster.start_worker(2);
  const JobStatus status = cluster.wait_end(cluster.submit(cluster.spec(cluster.upload_scene("bad"))));
  EXPECT_EQ(status.state, JobState::kFailed);
  EXPECT_EQ(status.failure, FailureKind::kBadInput);
  EXPECT_EQ(status.message, "scene.pbrt:1:1: unknown shape 'qaud'");
}

TEST(Faults, AWorkerThatAlwaysFailsEndsTheJob) {
  Cluster cluster(test_name());
  cluster.start_server();
  cluster.start_worker(1);
  const JobStatus status = cluster.wait_end(cluster.submit(cluster.spec(cluster.upload_scene("error"))));
  EXPECT_EQ(status.state, JobState::kFailed);
  EXPECT_EQ(status.failure, FailureKind::kJobFailed);
  EXPECT_NE(status.message.find("went bang"), std::string::npos) << status.message;
}

TEST(Faults, APilotTurnsSecondsIntoPasses) {
  Cluster cluster(test_name());
  cluster.start_server();
  cluster.start_worker(2);
  JobSpec spec = cluster.spec(cluster.upload_scene("0"));
  spec.budget = CpuSecondsBudget{0.12};  // the fake says 1 ms per pass and tile, six tiles
  const JobId job = cluster.submit(spec);
  EXPECT_EQ(cluster.wait_end(job).plan, (std::vector<int64_t>{20, 20}));
  Picture picture;
  const RunSummary summary = cluster.fetch(job, picture);
  EXPECT_NEAR(summary.mixes[0].cpu_seconds, 0.12, 1e-9);
  EXPECT_EQ(summary.mixes[0].substitutions, std::vector<std::string>{"a substitution"});
  EXPECT_EQ(summary.load.warnings, std::vector<std::string>{"a warning"});
}

TEST(Faults, APlanOfAutoOutlivesTheServerAndReplays) {
  Cluster cluster(test_name());
  cluster.start_server();
  cluster.start_worker(2);
  JobSpec spec = cluster.spec(cluster.upload_scene("4"));
  spec.mixes[1] = *parse_mix("auto");
  spec.budget = CpuSecondsBudget{1};
  const JobId job = cluster.submit(spec);
  cluster.wait_until(job, 30,
                     [](const JobStatus& s) { return s.state == JobState::kRunning && s.tasks_done >= 2; });
  cluster.server().kill_hard();
  cluster.start_server();
  EXPECT_EQ(cluster.wait_end(job).state, JobState::kDone);
  Picture picture;
  const RunSummary summary = cluster.fetch(job, picture);
  ASSERT_EQ(summary.auto_plans.size(), 1u);
  ASSERT_EQ(summary.auto_plans[0].tiles.size(), tiles_of(spec).size());
  EXPECT_GT(summary.mixes[1].pilot_cpu_seconds, 0);
  EXPECT_GT(summary.mixes[1].cpu_seconds, summary.mixes[1].pilot_cpu_seconds)
      << "the pilot is part of its cost";

  // Each pixel has its tile's passes, or its block's share of them.
  const auto tiles = tiles_of(spec);
  for (size_t t = 0; t < tiles.size(); ++t) {
    const size_t pixel =
        static_cast<size_t>(tiles[t].y0 - spec.crop.y0) * static_cast<size_t>(spec.crop.width()) +
        static_cast<size_t>(tiles[t].x0 - spec.crop.x0);
    const TilePlan& plan = summary.auto_plans[0].tiles[t];
    const auto passes = static_cast<int64_t>(picture.samples[1][pixel]);
    if (plan.shares.empty() || plan.shares[0] == kWholeShare) {
      EXPECT_EQ(passes, plan.passes);
    } else {
      EXPECT_GT(passes, 0);
      EXPECT_LE(passes, plan.passes);
    }
  }

  spec.plan = summary.status.plan;
  spec.auto_plans = summary.auto_plans;
  spec.earlier_plans = summary.earlier_plans;
  const JobId again = cluster.submit(spec);
  EXPECT_EQ(cluster.wait_end(again).state, JobState::kDone);
  Picture replayed;
  const RunSummary second = cluster.fetch(again, replayed);
  EXPECT_TRUE(replayed == picture) << "pixels differ";
  EXPECT_EQ(second.auto_plans, summary.auto_plans);
  EXPECT_EQ(second.mixes[1].pilot_cpu_seconds, 0) << "a stored plan needs no pilot";
}

}  // namespace
}  // namespace penumbra
