#include "proto/blocks.h"
#include "tests/unit/server/scheduler_fixture.h"

namespace penumbra {
namespace {

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

TEST_F(SchedulerTest, APilotThatNamesAResultIsRefused) {
  submit(CpuSecondsBudget{1});
  WorkerState a = worker("a", "0");
  sync(a);
  finish_all(a);
  ASSERT_EQ(a.completed.size(), 1u);
  ASSERT_TRUE(a.completed[0].result.empty()) << "a pilot";
  // There is no such blob: a server that stored the result would look for it on its disk, in vain.
  a.completed[0].result = Digest(64, 'c');
  sync(a);
  for (const Change& change : changes_) EXPECT_FALSE(std::holds_alternative<PutResult>(change));
}

TEST_F(SchedulerTest, WhatAWorkerSaysIsKeptShort) {
  const JobId job = submit(SppBudget{16});
  WorkerState a = worker("a", "0");
  sync(a);
  a.failed.push_back({a.held[0].lease, TaskFailure::kBadInput, std::string(60'000, 'x'), {}});
  a.held.clear();
  sync(a);
  EXPECT_EQ(scheduler_.find(job)->header.state, JobState::kFailed);
  EXPECT_LE(scheduler_.find(job)->header.message.size(), 5000u);
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

TEST_F(SchedulerTest, ABlockOfAnAutomaticMixMustHaveThePassesOfItsShare) {
  JobSpec spec = spec_of(SppBudget{8});
  spec.mixes = {*parse_mix("auto")};
  spec.plan = {8};
  // 8 × 8 blocks of a tile of 64 × 64: all in every second pass but the first.
  std::vector<uint8_t> shares(64, 128);
  shares[0] = kWholeShare;
  spec.auto_plans = {{0, {*parse_mix("sa:1")}, {{0, 8, shares}, {0, 8}}}};
  const JobId job = scheduler_.submit("j1", "request", spec, now_);
  WorkerState a = worker("a", "0", 2);
  sync(a);
  ASSERT_FALSE(a.held.empty());
  finish_all(a);
  const WorkerState told = a;
  std::vector<absl::StatusOr<ResultShape>> shapes;
  for (const CompletedTask& done : told.completed) {
    ResultShape shape = *this->shape(done);
    const TileTask& task = tasks_.at(done.lease);
    if (!task.chosen[0].shares.empty()) {
      shape.block_passes.resize(1);
      for (const uint8_t share : task.chosen[0].shares)
        shape.block_passes[0].push_back(
            int32_t(passes_of_block(task.passes[0].end, share, task.chosen[0].group) -
                    passes_of_block(task.passes[0].begin, share, task.chosen[0].group)));
      shape.block_passes[0].back() += 1;  // the garbage
    }
    shapes.emplace_back(shape);
  }
  ASSERT_TRUE(scheduler_.report(told, shapes, now_).ok());
  const JobRecord& record = *scheduler_.find(job);
  ASSERT_EQ(record.blames.size(), 1u);
  EXPECT_EQ(record.header.faults.refused_results, 1u);
  EXPECT_EQ(record.stage_done(), told.completed.size() - 1)
      << "what has no shares, or fits them, is accepted";
}

}  // namespace
}  // namespace penumbra
