// Disks, clocks, messages and workers that cannot be trusted: the picture is that of the undisturbed run,
// nothing is done twice that need not be, and the counts say what happened.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <chrono>
#include <cstring>
#include <fstream>
#include <limits>
#include <thread>

#include "proto/convert.h"
#include "tests/system/cluster/calm.h"
#include "tests/system/cluster/hand_worker.h"

namespace penumbra {
namespace {

void sleep_seconds(double seconds) {
  std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
}

void flip_last_byte(const std::string& path) {
  std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
  ASSERT_TRUE(file.seekg(-1, std::ios::end));
  const char byte = static_cast<char>(file.get() ^ 0x40);
  file.seekp(-1, std::ios::end);
  file.put(byte);
}

TEST(Durability, CorruptAndLostResultsAreRenderedAgain) {
  Cluster cluster(test_name());
  cluster.start_server();
  cluster.start_worker(2);
  const JobId job = cluster.submit(cluster.spec(cluster.upload_scene("0")));
  const JobStatus before = cluster.wait_end(job);
  const std::vector<std::string> files = cluster.result_files();
  ASSERT_EQ(files.size(), before.tasks_total);
  flip_last_byte(files[2]);
  std::filesystem::remove(files[5]);
  Picture picture;
  RunSummary summary;
  const grpc::Status cut = cluster.try_fetch(job, picture, summary);
  EXPECT_EQ(cut.error_code(), grpc::StatusCode::UNAVAILABLE);
  EXPECT_NE(cut.error_message().find("2 results"), std::string::npos) << cut.error_message();
  summary = expect_calm(cluster, job);
  EXPECT_EQ(summary.status.faults.corrupt_results, 2u);
  EXPECT_EQ(summary.status.retries, 2u) << "nothing else was rendered again";
  cluster.server().kill_hard();
  cluster.start_server();
  EXPECT_EQ(expect_calm(cluster, job).status.faults.corrupt_results, 2u) << "counted over a restart";
}

TEST(Durability, ACorruptCacheIsFetchedAgain) {
  Cluster cluster(test_name());
  cluster.start_server();
  Process& first = cluster.start_worker();
  const Digest bundle = cluster.upload_scene("0  ");
  expect_calm(cluster, cluster.submit(cluster.spec(bundle)));
  first.kill_hard();
  const Digest scene = sha256("0  ");
  const std::string cached = cluster.path("cache/" + scene.substr(0, 2) + "/" + scene);
  ASSERT_TRUE(std::filesystem::exists(cached));
  std::ofstream(cached) << "bad";  // of the same size: a scene that would fail its job
  cluster.start_worker();
  expect_calm(cluster, cluster.submit(cluster.spec(bundle)));
  std::string again;
  std::ifstream(cached) >> again;
  EXPECT_EQ(again, "0");
}

TEST(Durability, ASceneThatTheServerHasLostFailsItsJobAndCanBeSubmittedAgain) {
  Cluster cluster(test_name());
  cluster.start_server();
  const Digest bundle = cluster.upload_scene("0");
  const JobId job = cluster.submit(cluster.spec(bundle));
  flip_last_byte(cluster.blob_path(sha256("0")));
  cluster.start_worker();
  const JobStatus status = cluster.wait_end(job);
  EXPECT_EQ(status.failure, FailureKind::kJobFailed) << "not the scene's fault";
  EXPECT_NE(status.message.find("submit it again"), std::string::npos) << status.message;
  EXPECT_EQ(cluster.upload_scene("0"), bundle);
  expect_calm(cluster, cluster.submit(cluster.spec(bundle)));
}

TEST(Durability, AFullDiskStopsUploadsAndNothingElse) {
  Cluster cluster(test_name());
  std::filesystem::create_directories(cluster.path("store"));
  // A disk of 12 MB for the store alone, in a mount namespace of the server's own.
  cluster.server_prefix = {"unshare",
                           "--mount",
                           "sh",
                           "-c",
                           "mount -t tmpfs -o size=12m none '" + cluster.path("store") + "' && exec \"$@\"",
                           "sh"};
  cluster.server_flags = {"--reserve", "4M"};
  if (!Process({"unshare", "--mount", "sh", "-c", "mount -t tmpfs none /mnt"}, cluster.path("probe.log"))
           .wait(10)
           .value_or(1) == 0)
    GTEST_SKIP() << "no right to mount a small disk here";
  cluster.start_server();
  const std::string disk =
      "/proc/" + std::to_string(cluster.server().pid()) + "/root" + cluster.path("store");
  const JobId job = cluster.submit(cluster.spec(cluster.upload_scene("1")));
  const std::string ballast = disk + "/ballast";
  std::ofstream(ballast) << std::string(7800 << 10, 'x');
  cluster.start_worker(2);
  for (const double end = steady_seconds() + 30;
       cluster.status(job).tasks_leased == 0 && steady_seconds() < end;)
    sleep_seconds(0.05);
  sleep_seconds(3);
  const JobStatus full = cluster.status(job);
  EXPECT_EQ(full.state, JobState::kRunning);
  EXPECT_LT(full.tasks_done, full.tasks_total);
  EXPECT_EQ(full.faults.failures, 0u) << "a full disk is nobody's failure";
  std::filesystem::remove(ballast);
  EXPECT_EQ(expect_calm(cluster, job).status.retries, 0u) << "results were kept, not rendered again";
}

TEST(Durability, RepeatedReorderedAndLateMessagesChangeNothing) {
  Cluster cluster(test_name());
  cluster.server_flags = {"--silence", "2s"};
  cluster.start_server();
  const JobId job = cluster.submit(cluster.spec(cluster.upload_scene("2")));
  HandWorker hand(cluster, "hand");
  const WorkerState empty = hand.state;
  const std::vector<DesiredLease> leases = hand.take(3);
  ASSERT_EQ(leases.size(), 3u);
  const WorkerState holding = hand.state;
  ASSERT_TRUE(hand.say(empty).ok()) << "an older message comes last";
  const auto again = hand.say(holding);
  ASSERT_TRUE(again.ok());
  EXPECT_EQ(again->leases.size(), 3u) << "nothing was lost by that";
  // One is handed back, twice; the others' worker falls silent.
  WorkerState returning = holding;
  returning.wanted = 0;
  returning.held.pop_back();
  returning.failed.push_back({leases[2].lease, TaskFailure::kReturned, "back"});
  for (int i = 0; i < 2; ++i) ASSERT_TRUE(hand.say(returning).ok());
  EXPECT_EQ(cluster.status(job).faults.returned_leases, 1u);
  sleep_seconds(2.5);
  EXPECT_EQ(cluster.status(job).faults.lost_leases, 2u);
  cluster.start_worker(2);
  cluster.wait_until(job, 30, [](const JobStatus& s) { return s.tasks_done > 2; });
  // Now its results come, wrong in every pixel; each message twice, the older one last.
  WorkerState late = empty;
  late.completed = {hand.result_of(leases[0], flat_result(*leases[0].task, 7)),
                    hand.result_of(leases[1], flat_result(*leases[1].task, 7))};
  for (const WorkerState* told :
       std::initializer_list<const WorkerState*>{&late, &holding, &late, &empty, &holding}) {
    const auto answer = hand.say(*told);
    ASSERT_TRUE(answer.ok()) << answer.status();
    EXPECT_EQ(answer->acknowledged.size(), told->completed.size());
  }
  const RunSummary summary = expect_calm(cluster, job);
  EXPECT_EQ(summary.status.faults.late_results, 4u);
  EXPECT_EQ(summary.status.faults.failures, 0u);
}

TEST(Durability, GarbageIsRefusedAndItsWorkerCannotFailTheJob) {
  Cluster cluster(test_name());
  cluster.start_server();
  const JobId job = cluster.submit(cluster.spec(cluster.upload_scene("20")));
  cluster.start_worker();
  cluster.wait_until(job, 30, [](const JobStatus& s) { return s.tasks_leased > 0; });
  HandWorker hand(cluster, "hand");
  const auto garbage = [](const TileTask& task, int kind) -> std::string {
    TileTask other = task;
    if (kind == 0) return "certainly no result";
    if (kind == 1) other.tile = {0, 0, 8, 8};
    if (kind == 2) --other.passes[0].end;
    if (kind == 3) other.passes.pop_back();
    std::string bytes = flat_result(other, 1);
    const float nan = std::numeric_limits<float>::quiet_NaN();
    if (kind == 4) std::memcpy(bytes.data() + 44, &nan, sizeof nan);  // the first mean
    if (kind == 5) bytes.pop_back();
    return bytes;
  };
  uint64_t refused = 0;
  for (int kind = 0; kind < 6; ++kind) {
    std::vector<DesiredLease> leases;
    // It rests after each failure, for longer each time.
    for (const double end = steady_seconds() + 30; leases.empty() && steady_seconds() < end;
         sleep_seconds(0.1)) {
      if (is_final(cluster.status(job).state)) break;
      leases = hand.take(1);
    }
    if (leases.empty()) break;
    hand.state.held.clear();
    const std::string bytes = garbage(*leases[0].task, kind);
    // Every other comes with the report, the first of them with bytes that its digest does not name.
    hand.state.completed = {hand.result_of(leases[0], bytes)};
    if (kind % 2 == 1) hand.state.completed[0].bytes = kind == 1 ? bytes + '.' : bytes;
    hand.state.wanted = 0;
    const auto answer = hand.say(hand.state);
    ASSERT_TRUE(answer.ok());
    EXPECT_EQ(answer->acknowledged.size(), 1u);
    EXPECT_EQ(cluster.status(job).faults.refused_results, ++refused) << "kind " << kind;
    hand.state.completed.clear();
  }
  EXPECT_GE(refused, 3u);
  expect_calm(cluster, job);
}

TEST(Durability, AWorkerThatComputesForEverLosesItsTasksAndGetsNoMore) {
  Cluster cluster(test_name());
  cluster.server_flags = {"--task-limit", fmt::format("{}s", patience())};
  cluster.worker_prefix = {"env", "PENUMBRA_FAKE=endless"};
  cluster.start_server();
  cluster.start_worker();
  const JobId job = cluster.submit(cluster.spec(cluster.upload_scene("1")));
  cluster.wait_until(job, 30, [](const JobStatus& s) { return s.tasks_leased > 0; });
  cluster.worker_prefix.clear();
  cluster.start_worker(1, "another-cache");
  const RunSummary summary = expect_calm(cluster, job);
  EXPECT_GE(summary.status.faults.overdue_leases, 1u);
  EXPECT_LE(summary.status.faults.overdue_leases, 2u) << "it was given more than its first tasks";
}

// A commit that takes longer than silence may last: nobody was silent, the server did not listen.
TEST(Durability, ASlowDiskCostsTimeAndNothingElse) {
  Cluster cluster(test_name());
  const std::string disk = cluster.path("disk");
  std::ofstream(disk) << 0;
  cluster.server_prefix = {"env", std::string("LD_PRELOAD=") + PENUMBRA_SLOW_DISK,
                           "PENUMBRA_DISK_FILE=" + disk};
  cluster.server_flags = {"--silence", "1s"};
  cluster.start_server();
  for (int i = 0; i < 3; ++i) cluster.start_worker();
  const JobId job = cluster.submit(cluster.spec(cluster.upload_scene("6")));
  cluster.wait_until(job, 30, [](const JobStatus& s) { return s.tasks_done > 0; });
  std::ofstream(disk) << 800;  // twice a commit: results, then the log
  sleep_seconds(8);
  const JobStatus slow = cluster.status(job);
  std::ofstream(disk) << 0;
  EXPECT_EQ(slow.state, JobState::kRunning) << "it was to be slow long before its end";
  const RunSummary summary = expect_calm(cluster, job);
  EXPECT_EQ(summary.status.retries, 0u);
  EXPECT_EQ(summary.status.faults.lost_leases, 0u);
}

TEST(Durability, ClockJumpsCostNothing) {
  Cluster cluster(test_name());
  const std::string clock = cluster.path("clock");
  std::ofstream(clock) << 0;
  const std::vector<std::string> jumping = {"env", std::string("LD_PRELOAD=") + PENUMBRA_JUMPING_CLOCK,
                                            "PENUMBRA_CLOCK_FILE=" + clock};
  cluster.server_prefix = cluster.worker_prefix = jumping;
  cluster.start_server();
  cluster.start_worker(2);
  const JobId job = cluster.submit(cluster.spec(cluster.upload_scene("6")));
  constexpr long kYear = 365 * 86400L;
  uint64_t done = 0;
  for (const long jump : {kYear, -10 * kYear, 3600L, -60L, 0L}) {
    done =
        cluster
            .wait_until(job, 30, [&](const JobStatus& s) { return s.tasks_done > done || is_final(s.state); })
            .tasks_done;
    std::ofstream(clock) << jump;
  }
  const RunSummary summary = expect_calm(cluster, job);
  EXPECT_EQ(summary.status.retries, 0u);
  EXPECT_EQ(summary.status.faults.lost_leases, 0u);
  EXPECT_GE(summary.total_wall_seconds, 0);
}

TEST(Durability, FinishedJobsAgeOutWithTheirBlobs) {
  Cluster cluster(test_name());
  cluster.start_server();
  cluster.start_worker(2);
  const JobId job = cluster.submit(cluster.spec(cluster.upload_scene("0")));
  cluster.wait_end(job);
  EXPECT_FALSE(cluster.result_files().empty());
  cluster.server().kill_hard();
  cluster.server_flags = {"--keep", "2s", "--keep-uploads", "2s"};
  cluster.start_server();
  const JobId slow = cluster.submit(cluster.spec(cluster.upload_scene("60")));
  const auto count = [&] {
    grpc::ClientContext context;
    v1::ListJobsResponse jobs;
    EXPECT_TRUE(cluster.render().ListJobs(&context, {}, &jobs).ok());
    return jobs.jobs_size();
  };
  for (const double end = steady_seconds() + 20; count() > 1 && steady_seconds() < end;) sleep_seconds(0.2);
  EXPECT_EQ(count(), 1);
  EXPECT_EQ(cluster.status(slow).job, slow) << "a job that is not finished stays";
  sleep_seconds(3);
  EXPECT_FALSE(std::filesystem::exists(cluster.blob_path(sha256("0")))) << "nobody names it any more";
  EXPECT_TRUE(std::filesystem::exists(cluster.blob_path(sha256("60")))) << "the running job does";
}

TEST(Durability, ALargeSceneDoesNotAgeOutItsJobs) {
  Cluster cluster(test_name());
  cluster.server_flags = {"--keep-bytes", "1300K", "--keep-uploads", "2s"};
  cluster.start_server();
  cluster.start_worker(2);
  const JobId job = cluster.submit(cluster.spec(cluster.upload_scene("0" + std::string(1 << 19, ' '))));
  cluster.wait_end(job);
  sleep_seconds(5);  // two sweeps
  EXPECT_EQ(cluster.status(job).job, job) << "its results have a megabyte, and the scene half of one more";
}

}  // namespace
}  // namespace penumbra
