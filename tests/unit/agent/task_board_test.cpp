#include "worker/agent/task_board.h"

#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "worker/agent/flags.h"
#include "worker/agent/identity.h"

namespace penumbra {
namespace {

DesiredState leases(const std::vector<LeaseId>& ids, bool described = true) {
  DesiredState desired;
  JobSpec spec;
  desired.jobs = {{"j", spec}};
  for (const LeaseId& id : ids) {
    TileTask task;
    task.id = id.task;
    desired.leases.push_back({id, described ? std::optional(task) : std::nullopt});
  }
  return desired;
}

WorkerState told(TaskBoard& board) {
  WorkerState state;
  board.describe(state);
  return state;
}

TEST(TaskBoard, TasksGoFromLeaseToAcknowledgement) {
  TaskBoard board(2);
  const LeaseId id{"j", 1, 1};
  WorkerState state = told(board);
  EXPECT_EQ(state.wanted, 4u);
  EXPECT_TRUE(board.apply(leases({id}), state).empty());
  EXPECT_FALSE(told(board).held.at(0).begun);
  const auto assignment = board.take();
  EXPECT_TRUE(told(board).held.at(0).begun);
  auto finished = std::make_shared<Finished>();
  finished->report.lease = id;
  EXPECT_FALSE(board.wait_for_news(0));
  board.complete(*assignment, finished);
  EXPECT_TRUE(board.wait_for_news(0));
  state = told(board);
  EXPECT_EQ(state.completed.size(), 1u);
  EXPECT_TRUE(state.held.empty());
  // Not acknowledged and still wanted: the server has lost the blob.
  EXPECT_EQ(board.apply(leases({id}, false), state).size(), 1u);
  DesiredState acknowledged;
  acknowledged.acknowledged = {id};
  board.apply(acknowledged, told(board));
  EXPECT_TRUE(board.empty());
}

/// Leases, takes and completes tasks 1 to n of job j, each with so many bytes that travel along.
void complete_along(TaskBoard& board, uint64_t n, size_t bytes) {
  for (uint64_t task = 1; task <= n; ++task) {
    const LeaseId id{"j", task, 1};
    board.apply(leases({id}), {});
    const auto assignment = board.take();
    auto finished = std::make_shared<Finished>();
    finished->report.lease = id;
    finished->report.result = Digest(64, 'a');
    finished->bytes = std::string(bytes, 'x');
    finished->along = true;
    board.complete(*assignment, finished);
  }
}

// What does not fit into one Sync must not look lost to the server, nor wait for other news.
TEST(TaskBoard, ResultsThatTravelAlongFillNoMoreThanAMegabyteOfASync) {
  TaskBoard board(4);
  complete_along(board, 6, kMostBytesAlong);
  const WorkerState first = told(board);
  ASSERT_EQ(first.completed.size(), 4u);
  for (const CompletedTask& task : first.completed) EXPECT_EQ(task.bytes.size(), kMostBytesAlong);
  ASSERT_EQ(first.held.size(), 2u);
  for (const HeldLease& held : first.held) EXPECT_TRUE(held.begun);
  EXPECT_TRUE(board.wait_for_news(0));
  DesiredState desired = leases({{"j", 5, 1}, {"j", 6, 1}}, false);
  for (const CompletedTask& task : first.completed) desired.acknowledged.push_back(task.lease);
  EXPECT_TRUE(board.apply(desired, first).empty());
  const WorkerState second = told(board);
  EXPECT_EQ(second.completed.size(), 2u);
  EXPECT_TRUE(second.held.empty());
  EXPECT_FALSE(board.wait_for_news(0));
}

TEST(TaskBoard, WhatTheServerHadNoRoomForIsUploadedOnceAndReportedWhenItIsThere) {
  TaskBoard board(1);
  complete_along(board, 1, 100);
  const LeaseId id{"j", 1, 1};
  const DesiredState still_leased = leases({id}, false);
  const auto missing = board.apply(still_leased, told(board));
  ASSERT_EQ(missing.size(), 1u);
  WorkerState state = told(board);
  EXPECT_TRUE(state.completed.empty()) << "it would be asked for again and again";
  ASSERT_EQ(state.held.size(), 1u);
  EXPECT_TRUE(board.apply(still_leased, state).empty());
  EXPECT_TRUE(board.wants(id));
  board.uploaded(*missing.front());
  EXPECT_TRUE(board.wait_for_news(0));
  state = told(board);
  ASSERT_EQ(state.completed.size(), 1u);
  EXPECT_TRUE(state.completed.front().bytes.empty());
}

TEST(TaskBoard, AnUploadThatNobodyWantsAnyMoreIsNotGoneOnWith) {
  TaskBoard board(1);
  complete_along(board, 1, 100);
  (void)board.apply(leases({{"j", 1, 1}}, false), told(board));
  board.apply({}, told(board));  // cancelled
  EXPECT_FALSE(board.wants({"j", 1, 1}));
  EXPECT_TRUE(board.empty());
}

// A call that reports cannot be hurried: news must not wake whoever waits for its end, again and again.
TEST(TaskBoard, NewsDoNotEndAWaitForTheAnswer) {
  TaskBoard board(1);  // a new one has news
  bool done = false;
  EXPECT_EQ(board.wait_for_news_or(done, 60), TaskBoard::Woken::kNews);
  constexpr double kSeconds = 0.05;
  const auto start = std::chrono::steady_clock::now();
  EXPECT_FALSE(board.wait_for(done, kSeconds));
  EXPECT_GE(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(), kSeconds);
  std::thread caller([&] { board.set(done); });
  EXPECT_TRUE(board.wait_for(done, 60));
  caller.join();
  EXPECT_EQ(board.wait_for_news_or(done, 60), TaskBoard::Woken::kDone);
}

TEST(TaskBoard, WhatIsNoLongerDesiredIsCancelled) {
  TaskBoard board(2);
  const LeaseId begun{"j", 1, 1}, waiting{"j", 2, 1};
  board.apply(leases({begun, waiting}), told(board));
  const auto assignment = board.take();
  EXPECT_EQ(assignment->lease, begun);
  board.apply(DesiredState{}, told(board));
  EXPECT_TRUE(assignment->cancel);
  EXPECT_TRUE(told(board).held.empty());
  EXPECT_EQ(told(board).wanted, 2u) << "a thread that does not notice takes no leases";
  board.drop(*assignment);
  EXPECT_EQ(told(board).wanted, 4u);
  EXPECT_TRUE(board.empty());
}

TEST(TaskBoard, AThreadThatGoesOnInVainFillsItsPlaces) {
  TaskBoard board(1);
  EXPECT_FALSE(board.full());
  const LeaseId id{"j", 1, 1};
  board.apply(leases({id}), told(board));
  const auto assignment = board.take();
  EXPECT_FALSE(board.full()) << "one of two";
  board.apply(leases({}), told(board));
  const WorkerState state = told(board);
  EXPECT_EQ(state.wanted, 0u);
  EXPECT_TRUE(state.held.empty());
  EXPECT_TRUE(board.full()) << "else it would call without a pause";
  board.drop(*assignment);
  EXPECT_FALSE(board.full());
}

TEST(TaskBoard, AnAnswerToAnOlderStateDropsNothingNewer) {
  TaskBoard board(2);
  const WorkerState before = told(board);
  const LeaseId id{"j", 1, 1};
  board.apply(leases({id}), before);
  board.apply(DesiredState{}, before);  // answers a call that did not tell of the lease
  EXPECT_EQ(told(board).held.size(), 1u);
}

TEST(TaskBoard, DrainingHandsBackAndTakesNothingNew) {
  TaskBoard board(2);
  const LeaseId begun{"j", 1, 1}, waiting{"j", 2, 1}, late{"j", 3, 1};
  board.apply(leases({begun, waiting}), told(board));
  const auto assignment = board.take();
  board.drain();
  WorkerState state = told(board);
  EXPECT_TRUE(state.draining);
  EXPECT_EQ(state.wanted, 0u);
  ASSERT_EQ(state.failed.size(), 1u);
  EXPECT_EQ(state.failed[0].lease, waiting);
  EXPECT_EQ(state.failed[0].reason, TaskFailure::kReturned);
  board.apply(leases({begun, late}), state);
  EXPECT_EQ(told(board).failed.size(), 2u);
  EXPECT_FALSE(assignment->cancel);
  board.abandon();
  EXPECT_TRUE(assignment->cancel);
  EXPECT_EQ(told(board).failed.size(), 3u);
}

TEST(TaskBoard, ClosingWakesTheThreads) {
  TaskBoard board(1);
  std::thread thread([&] { EXPECT_EQ(board.take(), nullptr); });
  board.close();
  thread.join();
}

TEST(TaskBoard, ALoadIsReportedOnce) {
  TaskBoard board(1);
  board.loaded({"j", {}, {}});
  board.loaded({"j", {}, {}});
  WorkerState state = told(board);
  EXPECT_EQ(state.loaded.size(), 1u);
  DesiredState desired;
  desired.acknowledged_loads = {"j"};
  board.apply(desired, state);
  board.loaded({"j", {}, {}});
  EXPECT_TRUE(told(board).loaded.empty());
}

TEST(Flags, AmountsAreReadOrRefusedByName) {
  EXPECT_EQ(*parse_duration_flag("--drain-after", "500ms"), 0.5);
  EXPECT_EQ(*parse_duration_flag("--drain-after", "2m"), 120);
  EXPECT_EQ(*parse_bytes_flag("--max-memory", "8G"), uint64_t{8} << 30);
  for (const char* bad : {"", "0s", "-1s", "5", "nans", "infs", "1x", "s"}) {
    const auto refused = parse_duration_flag("--drain-after", bad);
    EXPECT_TRUE(absl::IsInvalidArgument(refused.status())) << bad;
  }
  EXPECT_FALSE(parse_bytes_flag("--max-memory", "8").ok());
}

TEST(Identity, SlotsDifferSideBySideAndAreTakenAgain) {
  const std::string cache = testing::TempDir() + "/slots-test";
  auto first = std::make_unique<Slot>(*Slot::take(cache));
  const auto second = Slot::take(cache);
  EXPECT_EQ(first->number(), 0);
  EXPECT_EQ(second->number(), 1);
  first.reset();
  EXPECT_EQ(Slot::take(cache)->number(), 0);
  EXPECT_NE(make_worker_info(1).id, make_worker_info(1).id);
  EXPECT_EQ(make_worker_info(1).id.size(), 36u);
}

}  // namespace
}  // namespace penumbra
