#include "server/http_metrics.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace penumbra {
namespace {

using testing::HasSubstr;
using testing::Not;

JobView job(const char* id, JobState state, uint64_t done, uint64_t leased, uint64_t total) {
  JobView view;
  view.status.job = id;
  view.status.state = state;
  view.status.scene = "/s/\"quoted\"\n.pbrt";
  view.status.tasks_done = done;
  view.status.tasks_leased = leased;
  view.status.tasks_total = total;
  view.status.fraction = static_cast<double>(done) / static_cast<double>(total);
  view.status.cpu_seconds = 2.5;
  return view;
}

TEST(Metrics, CountJobsTasksAndWorkers) {
  Snapshot snapshot;
  snapshot.jobs = {job("j1", JobState::kRunning, 3, 2, 12), job("j2", JobState::kQueued, 0, 0, 5),
                   job("j3", JobState::kDone, 9, 0, 9)};
  WorkerView worker;
  worker.info = {"uuid", "node1", "avx2", 8};
  worker.name = "w0";
  worker.leases = 2;
  worker.draining = true;
  worker.silence_seconds = 1.5;
  snapshot.workers = {worker};
  const std::string text = metrics_text(snapshot);
  for (const char* line :
       {"penumbra_jobs{state=\"running\"} 1", "penumbra_jobs{state=\"failed\"} 0",
        "penumbra_tasks_waiting 12", "penumbra_tasks_leased 2", "penumbra_tasks_unfinished 14", "penumbra_render_cpu_seconds 7.5",
        "penumbra_workers 1", "penumbra_workers_draining 1", "penumbra_worker_threads 8",
        "penumbra_worker_leases{host=\"node1\",worker=\"w0\"} 2",
        "penumbra_worker_silence_seconds{host=\"node1\",worker=\"w0\"} 1.5", "# TYPE penumbra_jobs gauge",
        "# TYPE penumbra_server_cpu_seconds_total counter"})
    EXPECT_THAT(text, HasSubstr(line));
  EXPECT_THAT(text, HasSubstr("penumbra_job_fraction{job=\"j1\",scene=\"/s/\\\"quoted\\\"\\n.pbrt\"} 0.25"));
  EXPECT_THAT(text, Not(HasSubstr("job=\"j3\""))) << "what has ended is not listed";
}

}  // namespace
}  // namespace penumbra
