// The network between a worker and its server is cut for longer than the worker's leases last, and mended:
// the picture is that of the undisturbed run, no task is accepted twice, the counts tell of it, and the
// worker works on.
#include <gtest/gtest.h>

#include <chrono>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "tests/system/chaos/audit.h"
#include "tests/system/cluster/calm.h"
#include "tests/system/cluster/namespaces.h"

namespace penumbra {
namespace {

constexpr double kSilence = 2;

nlohmann::json run_json(Cluster& cluster, const JobId& job) {
  const std::string out = cluster.path("out-" + job);
  Process fetch({PENUMBRA_CLIENT, "fetch", job, "--server", cluster.address(), "--out", out},
                cluster.path("fetch.log"));
  EXPECT_EQ(fetch.wait(60), 0);
  return nlohmann::json::parse(std::ifstream(out + "/run.json"));
}

TEST(Partition, AWorkerThatWasCutOffForLongerThanItsLease) {
  TwoNetworks networks;  // before any thread of gRPC's
  if (!networks.missing().empty()) GTEST_SKIP() << networks.missing();
  (void)calm();

  Cluster cluster(test_name());
  cluster.listen_host = TwoNetworks::near();
  cluster.server_flags = {"--silence", std::to_string(kSilence) + "s", "--insecure"};
  cluster.start_server();
  cluster.worker_prefix = networks.far_prefix();
  cluster.worker_flags = {"--name", "far"};
  cluster.start_worker(2, "far");
  const JobId job = cluster.submit(cluster.spec(cluster.upload_scene("20")));
  cluster.wait_until(job, 60, [](const JobStatus& s) { return s.tasks_done > 0 && s.tasks_leased > 0; });

  networks.cut();
  const JobStatus before = cluster.status(job);
  cluster.worker_prefix.clear();
  cluster.worker_flags = {"--name", "near"};
  Process& near = cluster.start_worker(1, "near");
  // Longer than its tasks take: results that are ready wait on the far side.
  const auto fallen_back = [&](const JobStatus& s) { return s.retries > before.retries; };
  cluster.wait_until(job, 60, fallen_back);
  std::this_thread::sleep_for(std::chrono::duration<double>(2 * kSilence));
  networks.heal();

  const RunSummary summary = expect_calm(cluster, job, 120);
  EXPECT_GE(summary.status.retries, 1u);
  const nlohmann::json run = run_json(cluster, job);
  EXPECT_EQ(run.at("retries"), summary.status.retries);
  EXPECT_GE(run.at("faults").at("lost_leases"), 1u);

  // Alone now: what comes is the healed one's. TCP itself waits about as long as it was cut off before it
  // tries again.
  near.kill_hard();
  const JobId next = cluster.submit(cluster.spec(cluster.upload_scene("0")));
  const double mended = steady_seconds();
  expect_calm(cluster, next, 60);
  EXPECT_LT(steady_seconds() - mended, 30) << "the healed worker was not heard of for long";

  std::vector<JobStatus> statuses = {cluster.status(job), cluster.status(next)};
  cluster.worker(0).kill_hard();
  cluster.server().kill_hard();
  for (const std::string& fault : audit(cluster.path("store"), statuses)) ADD_FAILURE() << fault;
}

}  // namespace
}  // namespace penumbra
