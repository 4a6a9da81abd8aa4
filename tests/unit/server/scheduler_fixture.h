#pragma once
// A scheduler with a clock of its own, and workers that do what it says.
#include <gtest/gtest.h>

#include <map>
#include <string>
#include <vector>

#include "server/job_report.h"
#include "server/scheduler.h"

namespace penumbra {

inline JobSpec spec_of(Budget budget) {
  JobSpec spec;
  spec.scene = "/s.pbrt";
  spec.bundle = Digest(64, 'a');
  spec.mixes = {*parse_mix("sa:1"), *parse_mix("bsdf:1")};
  spec.budget = budget;
  spec.width = 128;
  spec.height = 64;
  spec.crop = {0, 0, 128, 64};
  return spec;
}

/// A worker that does what it is told, and a server around the scheduler; time stands still unless moved.
class SchedulerTest : public testing::Test {
 protected:
  WorkerState worker(const std::string& id, const std::string& name, uint32_t wanted = 1) {
    WorkerState state;
    state.worker = {id, "host", "avx2", 1};
    state.name = name;
    state.wanted = wanted;
    return state;
  }

  /// A Sync; afterwards state.held is what the server wants it to hold, with the tasks in tasks_.
  DesiredState sync(WorkerState& state) {
    std::vector<absl::StatusOr<ResultShape>> shapes;
    for (const CompletedTask& task : state.completed) shapes.push_back(shape(task));
    const absl::Status status = scheduler_.report(state, shapes, now_);
    EXPECT_TRUE(status.ok()) << status;
    SyncAnswer answer = scheduler_.answer(state, now_);
    for (const DesiredLease& lease : answer.desired.leases)
      if (lease.task) tasks_[lease.lease] = *lease.task;
    state.held.clear();
    for (const DesiredLease& lease : answer.desired.leases) state.held.push_back({lease.lease, true});
    state.completed.clear();
    state.failed.clear();
    collect();
    return answer.desired;
  }

  absl::StatusOr<ResultShape> shape(const CompletedTask& task) {
    if (task.result.empty()) return ResultShape{};
    ResultShape out{tasks_.at(task.lease).tile, {}};
    for (const PassRange& range : tasks_.at(task.lease).passes) out.passes.push_back(range.count());
    return out;
  }

  /// Moves everything held to completed.
  void finish_all(WorkerState& state) {
    for (const HeldLease& held : state.held) {
      const TileTask& task = tasks_.at(held.lease);
      CompletedTask done{held.lease, task.kind == TaskKind::kRun ? Digest(64, 'b') : Digest(), {}};
      for (const PassRange& range : task.passes)
        done.costs.push_back({task.kind == TaskKind::kRun ? range.count() : 2, 0.01, 10, 1, 0, 0});
      for (size_t m = 0; m < task.repilot.size(); ++m) {
        done.costs[m].repilot_passes = task.repilot[m].count();
        done.costs[m].repilot_seconds = slow_ * 0.005 * static_cast<double>(task.repilot[m].count());
      }
      state.completed.push_back(done);
    }
    state.held.clear();
  }

  void run_to_end(WorkerState& state, const JobId& job) {
    for (int i = 0; i < 100'000 && !scheduler_.find(job)->final(); ++i) {
      sync(state);
      finish_all(state);
    }
  }

  void collect() {
    for (Change& change : scheduler_.take_changes()) changes_.push_back(std::move(change));
  }

  JobId submit(Budget budget = SppBudget{4}) {
    return scheduler_.submit("j1", "request", spec_of(budget), now_);
  }

  double slow_ = 1;  ///< seconds of a repeated pass per second of the pilot's
  Scheduler scheduler_;
  Now now_{100, 1'000'000, 0};
  std::map<LeaseId, TileTask> tasks_;
  std::vector<Change> changes_;
};

}  // namespace penumbra
