// What people see of the queue: dependencies, shares, reasons, logs.
#include <gtest/gtest.h>
#include <signal.h>

#include <chrono>
#include <set>
#include <thread>

#include "proto/convert.h"
#include "tests/system/cluster/calm.h"
#include "tests/system/cluster/hand_worker.h"

namespace penumbra {
namespace {

std::string explained(Cluster& cluster, const JobId& job) {
  grpc::ClientContext context;
  v1::JobRequest request;
  request.set_job(job);
  v1::ExplainResponse response;
  EXPECT_TRUE(cluster.render().Explain(&context, request, &response).ok());
  std::string text;
  for (const std::string& reason : response.reasons()) text += reason + "\n";
  return text;
}

TEST(Queue, AJobWaitsForAnotherAndSaysSo) {
  Cluster cluster(test_name());
  cluster.start_server();
  const Digest bundle = cluster.upload_scene("2");
  const JobId first = cluster.submit(cluster.spec(bundle), {"ada", 0, {"shot=12"}, {}});
  const JobId second = cluster.submit(cluster.spec(bundle), {"ada", 100, {}, {first}});
  EXPECT_NE(explained(cluster, second).find("waits for job " + first), std::string::npos);
  EXPECT_NE(explained(cluster, second).find("No worker is connected"), std::string::npos);
  EXPECT_EQ(cluster.status(first).terms.labels, std::vector<std::string>{"shot=12"});
  cluster.start_worker(2);
  cluster.wait_until(first, 60, [&](const JobStatus& s) {
    EXPECT_TRUE(is_final(s.state) || cluster.status(second).tasks_done == 0 ||
                is_final(cluster.status(first).state));
    return is_final(s.state);
  });
  expect_calm(cluster, second);
  JobId third;
  EXPECT_EQ(cluster.try_submit(cluster.spec(bundle), {"", 0, {}, {"nonsense"}}, third).error_code(),
            grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_EQ(cluster.try_submit(cluster.spec(bundle), {"", 101, {}, {}}, third).error_code(),
            grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_EQ(cluster.try_submit(cluster.spec(bundle), {"", 0, {"no equals sign"}, {}}, third).error_code(),
            grpc::StatusCode::INVALID_ARGUMENT);
}

TEST(Queue, TermsSurviveARestart) {
  Cluster cluster(test_name());
  cluster.start_server();
  const JobTerms terms{"ada", -3, {"shot=12", "take=2"}, {}};
  const JobId job = cluster.submit(cluster.spec(cluster.upload_scene("0")), terms);
  cluster.server().kill_hard();
  cluster.start_server();
  EXPECT_TRUE(cluster.status(job).terms == terms);
}

TEST(Queue, TheLogTellsWhatBecameOfEachTask) {
  Cluster cluster(test_name());
  cluster.start_server();
  const JobId job = cluster.submit(cluster.spec(cluster.upload_scene("1")));
  HandWorker hand(cluster, "hand");
  const auto leases = hand.take(1);
  ASSERT_EQ(leases.size(), 1u);
  hand.state.held.clear();
  hand.state.wanted = 0;
  hand.state.failed = {{leases[0].lease, TaskFailure::kError, "scene.pbrt:7:1: the mesh went bang"}};
  ASSERT_TRUE(hand.say(hand.state).ok());
  cluster.start_worker(2);
  expect_calm(cluster, job);
  grpc::ClientContext context;
  v1::LogRequest request;
  request.set_job(job);
  v1::LogResponse response;
  ASSERT_TRUE(cluster.render().Log(&context, request, &response).ok());
  std::set<uint64_t> done;
  bool failure = false;
  for (const auto& line : response.lines()) {
    if (line.text().find("done in") == 0) done.insert(line.task());
    failure |= line.worker() == "host-hand/hand" && line.task() == leases[0].lease.task &&
               line.text().find("scene.pbrt:7:1: the mesh went bang") != std::string::npos;
  }
  EXPECT_TRUE(failure);
  EXPECT_EQ(done.size(), cluster.status(job).tasks_total);
}

}  // namespace
}  // namespace penumbra
