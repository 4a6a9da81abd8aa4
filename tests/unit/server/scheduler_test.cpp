#include "tests/unit/server/scheduler_fixture.h"

namespace penumbra {
namespace {

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

TEST_F(SchedulerTest, WhileTheServerDoesNotListenNobodyIsSilent) {
  const JobId job = submit();
  WorkerState a = worker("a", "0");
  sync(a);
  now_.steady += 25;  // a commit
  scheduler_.excuse(25);
  now_.steady += 9.999;
  scheduler_.expire(now_);
  EXPECT_EQ(scheduler_.find(job)->leased(), 1u);
  now_.steady += 0.001;
  scheduler_.expire(now_);
  EXPECT_EQ(scheduler_.find(job)->leased(), 0u);
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

// It says how many tasks it wants before it knows that its thread renders what nobody waits for any more.
TEST_F(SchedulerTest, AWorkerThatLosesWhatItRendersIsGivenNothingInTheSameBreath) {
  const JobId job = submit();
  WorkerState a = worker("a", "0");
  sync(a);
  ASSERT_EQ(a.held.size(), 1u);
  ASSERT_TRUE(scheduler_.cancel(job, now_).ok());
  scheduler_.submit("j2", "other", spec_of(SppBudget{4}), now_);
  a.held[0].begun = true;
  const SyncAnswer told = scheduler_.answer(a, now_);
  EXPECT_TRUE(told.urgent);
  EXPECT_TRUE(told.desired.leases.empty());
  // What it has not begun it forgets at once.
  a.held[0].begun = false;
  EXPECT_EQ(scheduler_.answer(a, now_).desired.leases.size(), 1u);
}

TEST_F(SchedulerTest, TheSameRequestIsTheSameJob) {
  const JobId job = submit();
  EXPECT_EQ(scheduler_.submit("j2", "request", spec_of(SppBudget{4}), now_), job);
  EXPECT_NE(scheduler_.submit("j2", "other", spec_of(SppBudget{4}), now_), job);
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

}  // namespace
}  // namespace penumbra
