#include "tests/unit/server/scheduler_fixture.h"

namespace penumbra {
namespace {

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

TEST_F(SchedulerTest, ARestartTakesNoLeaseAwayForItsAge) {
  now_.steady = 1e6;  // a host that has been up for days
  const JobId job = submit(SppBudget{16});
  collect();
  WorkerState a = worker("a", "0", 2);
  sync(a);
  ASSERT_EQ(a.held.size(), 2u);
  scheduler_ = Scheduler();
  ASSERT_TRUE(scheduler_.restore(replay(changes_), now_).ok());
  now_.steady += 1;
  scheduler_.expire(now_);
  sync(a);
  EXPECT_EQ(a.held.size(), 2u);
  EXPECT_EQ(scheduler_.find(job)->header.faults.overdue_leases, 0u);
}

TEST_F(SchedulerTest, AJobThatIsNotUnderstoodKeepsNoOtherFromBeingServed) {
  const JobId good = submit(SppBudget{16});
  const JobId bad = scheduler_.submit("j2", "another request", spec_of(SppBudget{16}), now_);
  collect();
  StoredState stored = replay(changes_);
  for (StoredJob& job : stored.jobs)
    if (job.header.id == bad) job.results.push_back({{bad, uint64_t{1} << 40, 1}, Digest(64, 'b'), {}, "w"});
  stored.unreadable.emplace_back("gone", "too long");
  scheduler_ = Scheduler();
  ASSERT_TRUE(scheduler_.restore(stored, now_).ok());
  EXPECT_NE(scheduler_.find(good), nullptr);
  EXPECT_EQ(scheduler_.find(bad), nullptr);
  std::vector<std::string> said;
  for (const Notice& notice : scheduler_.take_notices())
    said.push_back(notice.about.job + ": " + notice.text);
  ASSERT_EQ(said.size(), 2u);
  EXPECT_EQ(said[0], "gone: stays in the store and is not served: too long");
  EXPECT_EQ(said[1].find(bad + ": stays in the store and is not served: "), 0u) << said[1];
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

}  // namespace
}  // namespace penumbra
