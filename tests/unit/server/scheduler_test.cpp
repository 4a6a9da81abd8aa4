#include "server/scheduler.h"

#include <gtest/gtest.h>

#include "server/job_report.h"

namespace penumbra {
namespace {

JobSpec spec_of(Budget budget) {
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

TEST_F(SchedulerTest, AJobRunsToItsEnd) {
  const JobId job = submit();
  WorkerState a = worker("a", "0", 4);
  run_to_end(a, job);
  const JobStatus status = status_of(scheduler_, *scheduler_.find(job), now_);
  EXPECT_EQ(status.state, JobState::kDone);
  EXPECT_EQ(status.fraction, 1);
  EXPECT_EQ(status.tasks_done, status.tasks_total);
  EXPECT_EQ(status.retries, 0u);
  EXPECT_EQ(status.plan, (std::vector<int64_t>{4, 4}));
}

TEST_F(SchedulerTest, ThePilotDecidesThePasses) {
  const JobId job = submit(CpuSecondsBudget{1});
  WorkerState a = worker("a", "0", 4);
  sync(a);
  EXPECT_EQ(scheduler_.find(job)->header.state, JobState::kPilot);
  run_to_end(a, job);
  // 0.005 s per pass and tile, 2 tiles: 100 passes for a second.
  EXPECT_EQ(scheduler_.find(job)->header.passes, (std::vector<int64_t>{100, 100}));
  EXPECT_EQ(scheduler_.find(job)->header.state, JobState::kDone);
  const RunSummary summary = summary_of(scheduler_, *scheduler_.find(job), now_);
  EXPECT_EQ(summary.mixes[0].passes, 100);
  EXPECT_EQ(summary.mixes[0].checkpoints.back().passes, 100);
  EXPECT_NEAR(summary.mixes[0].checkpoints.back().cpu_seconds, summary.mixes[0].cpu_seconds, 1e-12);
  // Two tiles in the pilot, and six of its passes repeated within the run.
  EXPECT_NEAR(summary.mixes[0].pilot_cpu_seconds, 0.02 + 6 * 0.005, 1e-12);
  ASSERT_EQ(summary.workers.size(), 1u);
  EXPECT_EQ(summary.tiles.size(), 4u);  // 2 tiles × 2 mixes, one worker
}

TEST_F(SchedulerTest, SilenceEndsLeasesAtTenSecondsSharp) {
  const JobId job = submit();
  WorkerState a = worker("a", "0");
  sync(a);
  ASSERT_EQ(scheduler_.find(job)->leased(), 1u);
  now_.steady += 9.999;
  scheduler_.expire(now_);
  EXPECT_EQ(scheduler_.find(job)->leased(), 1u);
  now_.steady = 110;
  EXPECT_EQ(scheduler_.next_expiry(), 110);
  scheduler_.expire(now_);
  EXPECT_EQ(scheduler_.find(job)->leased(), 0u);
  EXPECT_EQ(scheduler_.workers().size(), 0u);
}

TEST_F(SchedulerTest, ALateResultIsFencedByItsEpoch) {
  const JobId job = submit();
  WorkerState a = worker("a", "0"), b = worker("b", "1");
  sync(a);
  const LeaseId first = a.held[0].lease;
  now_.steady += 10;
  scheduler_.expire(now_);
  sync(b);
  ASSERT_EQ(b.held[0].lease.task, first.task);
  EXPECT_EQ(b.held[0].lease.epoch, first.epoch + 1);
  // a comes back with the result of a lease that it has lost: acknowledged, and thrown away.
  finish_all(a);
  a.wanted = 0;
  const DesiredState answer = sync(a);
  EXPECT_EQ(answer.acknowledged, std::vector<LeaseId>{first});
  EXPECT_FALSE(scheduler_.find(job)->results()[first.task].has_value());
  finish_all(b);
  sync(b);
  EXPECT_EQ(scheduler_.find(job)->results()[first.task]->worker, "b");
  EXPECT_EQ(scheduler_.find(job)->retries(), 1u);
}

TEST_F(SchedulerTest, AResultIsAcceptedOnce) {
  const JobId job = submit();
  WorkerState a = worker("a", "0");
  sync(a);
  finish_all(a);
  const WorkerState again = a;
  a.wanted = 0;
  sync(a);
  const uint64_t done = scheduler_.find(job)->stage_done();
  WorkerState duplicate = again;
  duplicate.wanted = 0;
  const DesiredState answer = sync(duplicate);
  EXPECT_EQ(answer.acknowledged.size(), 1u);
  EXPECT_EQ(scheduler_.find(job)->stage_done(), done);
  int results = 0;
  for (const Change& change : changes_) results += std::holds_alternative<PutResult>(change);
  EXPECT_EQ(results, 1);
}

TEST_F(SchedulerTest, ANewIncarnationEndsTheOldAtOnce) {
  const JobId job = submit();
  WorkerState old = worker("a", "0"), neighbour = worker("n", "1");
  sync(old);
  sync(neighbour);
  const LeaseId lost = old.held[0].lease;
  WorkerState fresh = worker("b", "0");
  sync(fresh);
  EXPECT_EQ(fresh.held[0].lease.task, lost.task);
  EXPECT_EQ(fresh.held[0].lease.epoch, lost.epoch + 1);
  EXPECT_EQ(scheduler_.find(job)->task(neighbour.held[0].lease.task)->state, TaskState::kLeased);
  EXPECT_TRUE(absl::IsFailedPrecondition(scheduler_.report(old, {}, now_)));
}

TEST_F(SchedulerTest, LeasesOfALostReplyAreToldAgain) {
  submit();
  WorkerState a = worker("a", "0");
  sync(a);
  const LeaseId lease = a.held[0].lease;
  a.held.clear();  // the reply never arrived
  const DesiredState again = sync(a);
  ASSERT_EQ(again.leases.size(), 1u);
  EXPECT_EQ(again.leases[0].lease, lease);
  EXPECT_TRUE(again.leases[0].task.has_value());
}

TEST_F(SchedulerTest, ASceneAtFaultFailsTheJobAtOnce) {
  const JobId job = submit();
  WorkerState a = worker("a", "0");
  sync(a);
  a.failed.push_back({a.held[0].lease, TaskFailure::kBadInput, "s.pbrt:3:1: unknown shape"});
  a.held.clear();
  sync(a);
  EXPECT_EQ(scheduler_.find(job)->header.state, JobState::kFailed);
  EXPECT_EQ(scheduler_.find(job)->header.failure, FailureKind::kBadInput);
  EXPECT_EQ(scheduler_.find(job)->header.message, "s.pbrt:3:1: unknown shape");
  EXPECT_TRUE(a.held.empty());
}

TEST_F(SchedulerTest, ThreeFailingWorkersFailTheJobWithTheReason) {
  const JobId job = submit();
  for (const std::string id : {"a", "b", "c"}) {
    ASSERT_FALSE(scheduler_.find(job)->final());
    WorkerState w = worker(id, id);
    sync(w);
    EXPECT_EQ(w.held[0].lease.task, 0u);
    w.failed.push_back({w.held[0].lease, TaskFailure::kError, "it went bang"});
    w.held.clear();
    w.wanted = 0;
    sync(w);
  }
  EXPECT_EQ(scheduler_.find(job)->header.state, JobState::kFailed);
  EXPECT_EQ(scheduler_.find(job)->header.failure, FailureKind::kJobFailed);
  EXPECT_NE(scheduler_.find(job)->header.message.find("it went bang"), std::string::npos);
}

TEST_F(SchedulerTest, OneWorkerAloneDoesNotFailForEver) {
  const JobId job = submit();
  WorkerState a = worker("a", "0");
  int rounds = 0;
  for (sync(a); !scheduler_.find(job)->final() && rounds < 100; ++rounds) {
    a.failed.push_back({a.held[0].lease, TaskFailure::kError, "bang"});
    a.held.clear();
    sync(a);
  }
  EXPECT_EQ(rounds, 5);
}

TEST_F(SchedulerTest, HandingBackIsNoFailure) {
  const JobId job = submit();
  WorkerState a = worker("a", "0");
  sync(a);
  for (int i = 0; i < 20; ++i) {
    a.failed.push_back({a.held[0].lease, TaskFailure::kReturned, ""});
    a.held.clear();
    sync(a);
  }
  EXPECT_FALSE(scheduler_.find(job)->final());
}

TEST_F(SchedulerTest, GarbageCountsAsFailureAndAMissingBlobIsAskedForAgain) {
  const JobId job = submit();
  WorkerState a = worker("a", "0");
  sync(a);
  finish_all(a);
  a.wanted = 0;
  const WorkerState told = a;
  ASSERT_TRUE(scheduler_.report(told, {absl::NotFoundError("gone")}, now_).ok());
  const SyncAnswer missing = scheduler_.answer(told, now_);
  EXPECT_TRUE(missing.desired.acknowledged.empty());
  EXPECT_EQ(missing.desired.leases.size(), 1u);
  ASSERT_TRUE(scheduler_.report(told, {ResultShape{{0, 0, 1, 1}, {1, 1}}}, now_).ok());
  EXPECT_EQ(scheduler_.answer(told, now_).desired.acknowledged.size(), 1u);
  EXPECT_EQ(scheduler_.find(job)->blames.size(), 1u);
  EXPECT_EQ(scheduler_.find(job)->stage_done(), 0u);
}

TEST_F(SchedulerTest, CancellingTakesTheTasksAway) {
  const JobId job = submit();
  WorkerState a = worker("a", "0");
  sync(a);
  ASSERT_TRUE(scheduler_.cancel(job, now_).ok());
  SyncAnswer answer = scheduler_.answer(a, now_);
  EXPECT_TRUE(answer.urgent);
  EXPECT_TRUE(answer.desired.leases.empty());
  EXPECT_EQ(scheduler_.find(job)->header.state, JobState::kCancelled);
  EXPECT_TRUE(scheduler_.cancel(job, now_).ok());
  EXPECT_TRUE(absl::IsNotFound(scheduler_.cancel("other", now_)));
}

TEST_F(SchedulerTest, TheSameRequestIsTheSameJob) {
  const JobId job = submit();
  EXPECT_EQ(scheduler_.submit("j2", "request", spec_of(SppBudget{4}), now_), job);
  EXPECT_NE(scheduler_.submit("j2", "other", spec_of(SppBudget{4}), now_), job);
}

TEST_F(SchedulerTest, NobodyHoardsTheLastTasks) {
  submit(SppBudget{1});  // two tasks
  WorkerState a = worker("a", "0", 8), b = worker("b", "1", 8);
  a.wanted = b.wanted = 0;
  sync(a);
  sync(b);
  a.wanted = b.wanted = 8;
  // Two tasks for two cores: not fewer than cores, so the first may take what it wants …
  sync(a);
  EXPECT_EQ(a.held.size(), 2u);
  scheduler_.submit("j2", "other", spec_of(SppBudget{1}), now_);
  WorkerState c = worker("c", "2", 8);
  c.wanted = 0;
  sync(c);
  c.wanted = 8;
  // … but with three cores and two tasks it takes one for its only core.
  sync(c);
  EXPECT_EQ(c.held.size(), 1u);
}

/// What a store would hold after these changes.
StoredState replay(const std::vector<Change>& changes) {
  StoredState state;
  const auto job = [&](const JobId& id) -> StoredJob& {
    for (StoredJob& known : state.jobs)
      if (known.header.id == id) return known;
    state.jobs.push_back({});
    state.jobs.back().header.id = id;
    return state.jobs.back();
  };
  const auto lease = [&](const LeaseId& id) -> StoredJob::Lease& {
    for (StoredJob::Lease& known : job(id.job).leases)
      if (known.lease.task == id.task) return known;
    job(id.job).leases.push_back({id, {}});
    return job(id.job).leases.back();
  };
  for (const Change& change : changes) {
    if (const auto* put = std::get_if<PutJob>(&change)) job(put->job.id).header = put->job;
    if (const auto* put = std::get_if<PutLease>(&change)) lease(put->lease) = {put->lease, put->holder};
    if (const auto* drop = std::get_if<DropLease>(&change)) lease(drop->lease).holder = {};
    if (const auto* put = std::get_if<PutResult>(&change)) job(put->lease.job).results.push_back(*put);
    if (const auto* put = std::get_if<PutBlame>(&change)) job(put->job).blames.push_back({*put, 1});
    if (const auto* drop = std::get_if<DropJob>(&change))
      std::erase_if(state.jobs, [&](const StoredJob& known) { return known.header.id == drop->job; });
    if (const auto* drop = std::get_if<DropResult>(&change)) {
      std::erase_if(job(drop->lease.job).results,
                    [&](const PutResult& result) { return result.lease.task == drop->lease.task; });
      lease(drop->lease).holder = {};
    }
    if (const auto* put = std::get_if<PutWorker>(&change)) state.workers.push_back(put->worker);
  }
  return state;
}

TEST_F(SchedulerTest, ARestartAnywhereGoesOn) {
  for (int stop_after = 0; stop_after < 12; ++stop_after) {
    SCOPED_TRACE(stop_after);
    scheduler_ = Scheduler();
    changes_.clear();
    tasks_.clear();
    now_ = {100, 1'000'000, 0};
    const JobId job = submit(CpuSecondsBudget{0.2});
    collect();
    WorkerState a = worker("a", "0", 2);
    for (int i = 0; i < stop_after; ++i) {
      sync(a);
      finish_all(a);
    }
    const uint64_t done = scheduler_.find(job)->stage_done();
    const auto passes = scheduler_.find(job)->header.passes;
    scheduler_ = Scheduler();
    ASSERT_TRUE(scheduler_.restore(replay(changes_), now_).ok());
    EXPECT_EQ(scheduler_.find(job)->stage_done(), done);
    EXPECT_EQ(scheduler_.find(job)->header.passes, passes);
    // The worker has survived: what it holds is still its own.
    const size_t reported = a.completed.size();
    const uint64_t before = scheduler_.find(job)->stage_done();
    a.wanted = 0;
    if (!scheduler_.find(job)->final() && scheduler_.find(job)->stage_total() - before > reported) {
      sync(a);
      EXPECT_EQ(scheduler_.find(job)->stage_done(), before + reported);
    }
    a.wanted = 2;
    run_to_end(a, job);
    EXPECT_EQ(scheduler_.find(job)->header.state, JobState::kDone);
    EXPECT_EQ(scheduler_.find(job)->retries(), 0u);
  }
}

TEST_F(SchedulerTest, ARestartWithinAStageGoesOnWithItsPlan) {
  slow_ = 1.5;
  std::vector<int64_t> passes;
  std::vector<EarlierPlan> earlier;
  size_t seen = 0;  // numbers of stages at restarts
  for (int stop_after = -1; stop_after < 24; ++stop_after) {
    SCOPED_TRACE(stop_after);
    scheduler_ = Scheduler();
    changes_.clear();
    tasks_.clear();
    const JobId job = submit(CpuSecondsBudget{1});
    collect();
    WorkerState a = worker("a", "0", 2);
    for (int i = 0; i < stop_after && !scheduler_.find(job)->final(); ++i) {
      sync(a);
      finish_all(a);
    }
    if (stop_after >= 0) {
      const JobHeader before = scheduler_.find(job)->header;
      scheduler_ = Scheduler();
      ASSERT_TRUE(scheduler_.restore(replay(changes_), now_).ok());
      EXPECT_EQ(scheduler_.find(job)->header.passes, before.passes);
      EXPECT_EQ(scheduler_.find(job)->header.earlier_plans, before.earlier_plans);
      EXPECT_EQ(scheduler_.find(job)->header.open_borders, before.open_borders);
      if (!before.passes.empty()) seen |= size_t{1} << before.open_borders.size();
    }
    run_to_end(a, job);
    const JobHeader& header = scheduler_.find(job)->header;
    ASSERT_EQ(header.state, JobState::kDone);
    EXPECT_EQ(scheduler_.find(job)->retries(), 0u);
    if (stop_after < 0) {
      passes = header.passes;
      earlier = header.earlier_plans;
      EXPECT_LT(passes[0], 90);
      EXPECT_EQ(earlier.size(), 2u);
    }
    EXPECT_EQ(header.passes, passes);
    EXPECT_EQ(header.earlier_plans, earlier);
  }
  EXPECT_EQ(seen, 7u) << "a restart in every stage";
}

TEST_F(SchedulerTest, BeyondWhatIsSureNothingIsGivenOutBeforeTheDecision) {
  slow_ = 0.9;
  const JobId job = submit(CpuSecondsBudget{1});
  WorkerState a = worker("a", "0", 2);
  sync(a);
  finish_all(a);
  sync(a);  // the pilot is done
  // Everything is leased, nothing done: the queue ends at the first border.
  a.wanted = 1000;
  sync(a);
  const JobRecord& record = *scheduler_.find(job);
  EXPECT_EQ(record.pending(), 0u);
  EXPECT_EQ(a.held.size(), record.plan()->sure * 2);
  EXPECT_LT(a.held.size(), record.stage_total());
  // Those that it waits for are fewer: the next stage is there while the last tasks of this one are rendered.
  const size_t measured = record.plan()->measured * 2;
  ASSERT_LT(measured, a.held.size());
  const std::vector<HeldLease> rest(a.held.begin() + static_cast<ptrdiff_t>(measured), a.held.end());
  a.held.resize(measured);
  finish_all(a);
  a.held = rest;
  a.wanted = 0;
  sync(a);
  EXPECT_EQ(record.header.earlier_plans.size(), 1u);
  EXPECT_GT(record.pending(), 0u);
}

TEST_F(SchedulerTest, ARestartGivesNobodyTheTasksOfACancelledJob) {
  const JobId job = submit();
  WorkerState a = worker("a", "0");
  sync(a);
  ASSERT_TRUE(scheduler_.cancel(job, now_).ok());
  collect();
  scheduler_ = Scheduler();
  ASSERT_TRUE(scheduler_.restore(replay(changes_), now_).ok());
  sync(a);
  EXPECT_TRUE(a.held.empty());
  EXPECT_EQ(scheduler_.find(job)->header.state, JobState::kCancelled);
}

TEST_F(SchedulerTest, ATaskThatNeverEndsIsTakenAway) {
  const JobId job = submit();
  WorkerState a = worker("a", "0", 2);
  sync(a);
  a.held[1].begun = false;
  sync(a);
  const LeaseId endless = a.held[0].lease, waiting = a.held[1].lease;
  for (int second = 0; second < 1799; ++second) {  // it renews its leases and makes no progress
    now_.steady += 1;
    scheduler_.expire(now_);
    a.held[1].begun = false;
    ASSERT_TRUE(scheduler_.report(a, {}, now_).ok());
  }
  EXPECT_EQ(scheduler_.find(job)->leased(), 2u);
  now_.steady += 1;
  scheduler_.expire(now_);
  EXPECT_EQ(scheduler_.find(job)->leased(), 0u);
  EXPECT_EQ(scheduler_.find(job)->header.faults.overdue_leases, 2u);
  EXPECT_TRUE(scheduler_.find(job)->blames.contains(endless.task));
  EXPECT_FALSE(scheduler_.find(job)->blames.contains(waiting.task)) << "it had not begun";
}

TEST_F(SchedulerTest, ALostResultIsRenderedAgainAlsoAfterARestart) {
  const JobId job = submit();
  WorkerState a = worker("a", "0", 2);
  run_to_end(a, job);
  collect();
  const uint64_t total = scheduler_.find(job)->stage_total();
  scheduler_.lose_results(job, {{1, Digest(64, 'c')}, {1, Digest(64, 'b')}, {1, Digest(64, 'b')}}, now_);
  collect();
  EXPECT_EQ(scheduler_.find(job)->header.state, JobState::kRunning);
  EXPECT_EQ(scheduler_.find(job)->stage_done(), total - 1);
  EXPECT_EQ(scheduler_.find(job)->header.faults.corrupt_results, 1u);
  scheduler_ = Scheduler();
  ASSERT_TRUE(scheduler_.restore(replay(changes_), now_).ok());
  EXPECT_EQ(scheduler_.find(job)->stage_done(), total - 1);
  sync(a);
  ASSERT_EQ(a.held.size(), 1u);
  EXPECT_EQ(a.held[0].lease, (LeaseId{job, 1, 2})) << "the epoch goes on";
  run_to_end(a, job);
  EXPECT_EQ(scheduler_.find(job)->header.state, JobState::kDone);
}

TEST_F(SchedulerTest, AMessageThatWasOvertakenCountsNothingTwice) {
  const JobId job = submit();
  WorkerState a = worker("a", "0");
  sync(a);
  for (const double seconds : {3.0, 1.0, 3.0, 4.0}) {
    a.process_cpu_seconds = seconds;
    sync(a);
  }
  EXPECT_EQ(scheduler_.find(job)->header.worker_cpu_seconds, 4);
}

TEST_F(SchedulerTest, AWorkerThatFailsLeavesTheTaskToOthers) {
  const JobId job = submit();
  WorkerState bad = worker("a", "0"), good = worker("b", "1");
  good.wanted = 0;
  sync(good);
  for (int i = 0; i < 20; ++i) {
    now_.steady += 60;  // however long it rests
    ASSERT_TRUE(scheduler_.report(good, {}, now_).ok());
    sync(bad);
    if (bad.held.empty()) continue;
    bad.failed.push_back({bad.held[0].lease, TaskFailure::kError, "bang"});
    bad.held.clear();
    sync(bad);
  }
  EXPECT_FALSE(scheduler_.find(job)->final());
  good.wanted = 2;
  run_to_end(good, job);
  EXPECT_EQ(scheduler_.find(job)->header.state, JobState::kDone);
}

TEST_F(SchedulerTest, AWorkerThatFailsThreeJobsInARowIsSetAside) {
  WorkerState bad = worker("a", "0"), good = worker("b", "1");
  good.wanted = 0;
  for (const std::string id : {"j1", "j2", "j3"}) {
    scheduler_.submit(id, id, spec_of(SppBudget{4}), now_);
    now_.steady += 60;
    sync(good);
    sync(bad);
    ASSERT_EQ(bad.held.size(), 1u);
    bad.failed.push_back({bad.held[0].lease, TaskFailure::kError, "it has no libc"});
    bad.held.clear();
    sync(bad);
    ASSERT_TRUE(scheduler_.cancel(id, now_).ok());
  }
  const JobId job = scheduler_.submit("j4", "j4", spec_of(SppBudget{4}), now_);
  now_.steady += 60;
  sync(good);
  sync(bad);
  EXPECT_TRUE(bad.held.empty());
  bool told = false;
  for (const std::string& reason : explain(scheduler_, *scheduler_.find(job), now_))
    told |=
        reason.find("set aside") != std::string::npos && reason.find("it has no libc") != std::string::npos;
  EXPECT_TRUE(told);
}

TEST_F(SchedulerTest, AWorkerThatFailsAloneIsNotSetAside) {
  WorkerState only = worker("a", "0");
  for (const std::string id : {"j1", "j2", "j3", "j4"}) {
    scheduler_.submit(id, id, spec_of(SppBudget{4}), now_);
    sync(only);
    ASSERT_EQ(only.held.size(), 1u) << id;
    only.failed.push_back({only.held[0].lease, TaskFailure::kError, "bang"});
    only.held.clear();
    only.wanted = 0;
    sync(only);
    only.wanted = 1;
    ASSERT_TRUE(scheduler_.cancel(id, now_).ok());
  }
}

TEST_F(SchedulerTest, FailuresCountOverRestarts) {
  const JobId job = submit();
  for (int restart = 0; restart < 5; ++restart) {
    ASSERT_FALSE(scheduler_.find(job)->final()) << restart;
    WorkerState a = worker("a" + std::to_string(restart), "0");
    sync(a);
    a.failed.push_back({a.held[0].lease, TaskFailure::kError, "bang"});
    a.held.clear();
    a.wanted = 0;
    sync(a);
    const StoredState stored = replay(changes_);
    scheduler_ = Scheduler();
    ASSERT_TRUE(scheduler_.restore(stored, now_).ok());
  }
  EXPECT_EQ(scheduler_.find(job)->header.state, JobState::kFailed);
}

TEST_F(SchedulerTest, OnlyFinalJobsAreForgotten) {
  const JobId job = submit();
  scheduler_.forget(job);
  ASSERT_NE(scheduler_.find(job), nullptr);
  ASSERT_TRUE(scheduler_.cancel(job, now_).ok());
  scheduler_.forget(job);
  EXPECT_EQ(scheduler_.find(job), nullptr);
  collect();
  EXPECT_TRUE(replay(changes_).jobs.empty());
  EXPECT_EQ(scheduler_.submit("j2", "request", spec_of(SppBudget{4}), now_), "j2")
      << "its request id is free";
}

TEST_F(SchedulerTest, UsersShareEvenlyAndPrioritiesOrderAUsersJobs) {
  const auto add = [&](const std::string& id, const std::string& user, int priority) {
    scheduler_.submit(id, id, spec_of(SppBudget{4}), now_, {user, priority, {}, {}});
  };
  add("a1", "ada", 0);
  add("a2", "ada", 5);
  add("a3", "ada", 0);
  add("b1", "bob", -100);
  WorkerState w = worker("w", "0", 4);
  w.worker.cores = 4;
  sync(w);
  std::map<JobId, int> held;
  for (const HeldLease& lease : w.held) ++held[lease.lease.job];
  EXPECT_EQ(held, (std::map<JobId, int>{{"a2", 2}, {"b1", 2}}));
  bool told = false;
  for (const std::string& reason : explain(scheduler_, *scheduler_.find("a1"), now_))
    told |= reason.find("higher priority") != std::string::npos;
  EXPECT_TRUE(told);
}

TEST_F(SchedulerTest, QuotasBoundJobsAndTasks) {
  SchedulerLimits limits;
  limits.quotas["ada"] = {2, 1};
  scheduler_ = Scheduler(limits);
  scheduler_.submit("a1", "a1", spec_of(SppBudget{4}), now_, {"ada", 0, {}, {}});
  EXPECT_TRUE(scheduler_.check_quota("ada").ok());
  scheduler_.submit("a2", "a2", spec_of(SppBudget{4}), now_, {"ada", 0, {}, {}});
  EXPECT_TRUE(absl::IsResourceExhausted(scheduler_.check_quota("ada")));
  EXPECT_TRUE(scheduler_.check_quota("bob").ok());
  WorkerState w = worker("w", "0", 4);
  sync(w);
  EXPECT_EQ(w.held.size(), 1u);
  EXPECT_NE(explain(scheduler_, *scheduler_.find("a1"), now_).at(0).find("quota"), std::string::npos);
}

TEST_F(SchedulerTest, AJobWaitsForThoseBeforeItAndFailsWithThem) {
  for (const bool succeeds : {true, false}) {
    scheduler_ = Scheduler();
    scheduler_.submit("first", "first", spec_of(SppBudget{4}), now_);
    scheduler_.submit("second", "second", spec_of(SppBudget{4}), now_, {"", 9, {}, {"first"}});
    scheduler_.submit("third", "third", spec_of(SppBudget{4}), now_, {"", 9, {}, {"second"}});
    WorkerState a = worker("a", "0", 1);
    sync(a);
    EXPECT_EQ(a.held.at(0).lease.job, "first");
    EXPECT_NE(explain(scheduler_, *scheduler_.find("second"), now_).at(0).find("waits for job first"),
              std::string::npos);
    if (succeeds) {
      run_to_end(a, "third");
      EXPECT_EQ(scheduler_.find("third")->header.state, JobState::kDone);
    } else {
      ASSERT_TRUE(scheduler_.cancel("first", now_).ok());
      EXPECT_EQ(scheduler_.find("third")->header.state, JobState::kFailed);
      EXPECT_NE(scheduler_.find("third")->header.message.find("second"), std::string::npos);
    }
  }
}

TEST_F(SchedulerTest, ALostInputFailsTheJobAndBlamesNobody) {
  const JobId job = submit();
  WorkerState a = worker("a", "0");
  sync(a);
  a.failed.push_back({a.held[0].lease, TaskFailure::kLostInput, "mesh.ply is gone"});
  a.held.clear();
  sync(a);
  EXPECT_EQ(scheduler_.find(job)->header.failure, FailureKind::kJobFailed);
  EXPECT_TRUE(scheduler_.find(job)->blames.empty());
}

TEST_F(SchedulerTest, ExplainSaysThatNobodyIsThere) {
  const JobId job = submit();
  const auto reasons = explain(scheduler_, *scheduler_.find(job), now_);
  EXPECT_NE(reasons.at(0).find("No worker"), std::string::npos);
}

}  // namespace
}  // namespace penumbra
