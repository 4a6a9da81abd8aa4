#include "server/sqlite_store.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

namespace penumbra {
namespace {

namespace fs = std::filesystem;

class SqliteStoreTest : public testing::Test {
 protected:
  void SetUp() override {
    path_ = fs::path(testing::TempDir()) /
            (std::string(testing::UnitTest::GetInstance()->current_test_info()->name()) + ".sqlite");
    TearDown();
  }
  void TearDown() override {
    for (const char* suffix : {"", "-wal", "-shm"}) fs::remove(path_.string() + suffix);
  }
  std::unique_ptr<JobStore> open() {
    auto store = open_sqlite_store(path_);
    EXPECT_TRUE(store.ok()) << store.status();
    return store.ok() ? *std::move(store) : nullptr;
  }
  static JobHeader header() {
    JobHeader job;
    job.id = "j1";
    job.request_id = "r1";
    job.spec.bundle = Digest(64, 'a');
    job.spec.mixes = {*parse_mix("sa:1")};
    job.spec.budget = SppBudget{4};
    job.spec.width = job.spec.height = 64;
    job.spec.crop = {0, 0, 64, 64};
    job.state = JobState::kRunning;
    job.message = "m";
    job.passes = {4};
    job.loaded = true;
    job.load.warnings = {"w"};
    job.substitutions = {{0, "s"}};
    job.submitted_unix = 1;
    job.first_lease_unix = 2;
    job.finished_unix = 3;
    job.worker_cpu_seconds = 4;
    job.scheduler_cpu_seconds = 5;
    return job;
  }

  fs::path path_;
};

TEST_F(SqliteStoreTest, WhatIsAppliedComesBack) {
  const LeaseId first{"j1", 0, 1}, second{"j1", 1, 1}, third{"j1", 2, 4};
  {
    const auto store = open();
    ASSERT_TRUE(store->apply({PutJob{header()}, PutLease{first, {"w", "h", "n"}}}).ok());
    ASSERT_TRUE(store
                    ->apply({PutLease{second, {"w", "h", "n"}}, PutLease{third, {"w", "h", "n"}},
                             DropLease{third}, PutWorker{{"w", "h", "avx2", 2}},
                             PutResult{first, Digest(64, 'c'), {{4, 0.5, 1, 2, 3, 0}}, "w"}})
                    .ok());
  }
  const auto state = open()->load();
  ASSERT_TRUE(state.ok()) << state.status();
  ASSERT_EQ(state->jobs.size(), 1u);
  EXPECT_TRUE(state->jobs[0].header == header());
  ASSERT_EQ(state->jobs[0].leases.size(), 2u);
  EXPECT_EQ(state->jobs[0].leases[0].lease, second);
  EXPECT_EQ(state->jobs[0].leases[0].holder, (LeaseHolder{"w", "h", "n"}));
  EXPECT_EQ(state->jobs[0].leases[1].lease, third);
  EXPECT_EQ(state->jobs[0].leases[1].holder.worker, "");
  ASSERT_EQ(state->jobs[0].results.size(), 1u);
  EXPECT_EQ(state->jobs[0].results[0].costs[0].cpu_seconds, 0.5);
  EXPECT_EQ(state->workers.size(), 1u);
}

TEST_F(SqliteStoreTest, ABatchIsAllOrNothing) {
  const auto store = open();
  const PutResult result{{"j1", 0, 1}, "", {}, "w"};
  ASSERT_TRUE(store->apply({PutJob{header()}, result}).ok());
  JobHeader changed = header();
  changed.message = "changed";
  EXPECT_FALSE(store->apply({PutJob{changed}, result}).ok());  // a second result of a task
  EXPECT_EQ(store->load()->jobs[0].header.message, "m");
}

TEST_F(SqliteStoreTest, AFileThatIsNotOursIsRefused) {
  std::ofstream(path_) << "certainly not a database, but long enough to look at";
  EXPECT_TRUE(absl::IsInvalidArgument(open_sqlite_store(path_).status()));
  EXPECT_TRUE(absl::IsInvalidArgument(open_sqlite_store("/nonexistent/folder/x").status()));
}

}  // namespace
}  // namespace penumbra
