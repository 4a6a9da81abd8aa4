#include "tests/unit/server/scheduler_fixture.h"

namespace penumbra {
namespace {

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

TEST_F(SchedulerTest, ExplainSaysThatNobodyIsThere) {
  const JobId job = submit();
  const auto reasons = explain(scheduler_, *scheduler_.find(job), now_);
  EXPECT_NE(reasons.at(0).find("No worker"), std::string::npos);
}

}  // namespace
}  // namespace penumbra
