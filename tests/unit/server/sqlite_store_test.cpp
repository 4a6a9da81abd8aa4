#include "server/sqlite_store.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "server/sqlite.h"
#include "server/stored_job.h"

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

  static std::string hex(std::string_view bytes) {
    std::string out;
    for (const char byte : bytes) out += fmt::format("{:02x}", static_cast<unsigned char>(byte));
    return out;
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

TEST_F(SqliteStoreTest, LogsAreKeptByTileUntilTheirJobGoes) {
  const auto log = [](uint64_t task, uint64_t epoch, double time) {
    return PutLog{{"j1", task, epoch}, "h/n", time, fmt::format("task {} epoch {}", task, epoch)};
  };
  ASSERT_TRUE(
      open()->apply({PutJob{header()}, log(0, 1, 10.5), log(1, 1, 11), log(3, 1, 12), log(0, 2, 13)}).ok());
  const auto store = open();
  const auto texts = [&](uint64_t modulus, uint64_t remainder, size_t most_bytes) {
    std::vector<std::string> out;
    const auto logs = store->logs("j1", modulus, remainder, most_bytes);
    for (const PutLog& kept : *logs) out.push_back(kept.text);
    return out;
  };
  using Texts = std::vector<std::string>;
  EXPECT_EQ(texts(1, 0, 99), (Texts{"task 0 epoch 1", "task 1 epoch 1", "task 3 epoch 1", "task 0 epoch 2"}));
  EXPECT_EQ(texts(1, 0, 28), (Texts{"task 3 epoch 1", "task 0 epoch 2"})) << "the latest of 14 bytes each";
  EXPECT_EQ(texts(1, 0, 27), Texts{"task 0 epoch 2"});
  EXPECT_EQ(texts(3, 0, 99), (Texts{"task 0 epoch 1", "task 3 epoch 1", "task 0 epoch 2"})) << "of one tile";
  const auto first = store->logs("j1", 3, 0, 99);
  EXPECT_EQ(first->front().worker, "h/n");
  EXPECT_EQ(first->front().unix_time, 10.5);
  EXPECT_EQ(first->front().lease, (LeaseId{"j1", 0, 1}));
  ASSERT_TRUE(store->apply({DropJob{"j1"}}).ok());
  EXPECT_EQ(texts(1, 0, 99), Texts{});
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

TEST_F(SqliteStoreTest, AStoreOfTheFirstVersionIsBroughtUpToDate) {
  {
    sqlite3* db = nullptr;
    ASSERT_EQ(sqlite3_open(path_.c_str(), &db), SQLITE_OK);
    const std::string sql = R"sql(
      CREATE TABLE jobs (number INTEGER PRIMARY KEY, id TEXT UNIQUE NOT NULL, header BLOB NOT NULL);
      CREATE TABLE leases (job TEXT NOT NULL, task INTEGER NOT NULL, epoch INTEGER NOT NULL,
        worker TEXT NOT NULL, host TEXT NOT NULL, name TEXT NOT NULL, PRIMARY KEY (job, task)) WITHOUT ROWID;
      CREATE TABLE results (job TEXT NOT NULL, task INTEGER NOT NULL, epoch INTEGER NOT NULL,
        result TEXT NOT NULL, costs BLOB NOT NULL, worker TEXT NOT NULL,
        PRIMARY KEY (job, task)) WITHOUT ROWID;
      CREATE TABLE workers (id TEXT PRIMARY KEY, info BLOB NOT NULL) WITHOUT ROWID;
      PRAGMA user_version = 1;
      INSERT INTO leases VALUES('j1', 7, 3, 'w', 'h', 'n');
      INSERT INTO jobs VALUES(1, 'j1', x')sql" +
                            hex(serialize_header(header())) + "');";
    ASSERT_EQ(sqlite3_exec(db, sql.c_str(), nullptr, nullptr, nullptr), SQLITE_OK) << sqlite3_errmsg(db);
    sqlite3_close(db);
  }
  for (int time = 0; time < 2; ++time) {  // the second time there is nothing left to do
    const auto state = open()->load();
    ASSERT_TRUE(state.ok()) << state.status();
    ASSERT_EQ(state->jobs.size(), 1u);
    EXPECT_TRUE(state->jobs[0].header == header());
    EXPECT_EQ(state->jobs[0].leases.at(0).lease, (LeaseId{"j1", 7, 3}));
    ASSERT_TRUE(open()->apply({PutBlame{"j1", 7, "h/n", false}}).ok());
  }
}

TEST_F(SqliteStoreTest, ANewerSchemaIsRefused) {
  open();
  sqlite3* db = nullptr;
  ASSERT_EQ(sqlite3_open(path_.c_str(), &db), SQLITE_OK);
  ASSERT_EQ(sqlite3_exec(db, "PRAGMA user_version = 99", nullptr, nullptr, nullptr), SQLITE_OK);
  sqlite3_close(db);
  EXPECT_TRUE(absl::IsInvalidArgument(open_sqlite_store(path_).status()));
}

TEST_F(SqliteStoreTest, BlamesAreCountedAndForgottenWithTheJob) {
  const auto store = open();
  const PutBlame blame{"j1", 3, "h/n", false}, death{"j1", 3, "w", true};
  ASSERT_TRUE(store->apply({PutJob{header()}, blame, death, blame}).ok());
  auto state = store->load();
  ASSERT_EQ(state->jobs.at(0).blames.size(), 2u);
  EXPECT_EQ(state->jobs[0].blames[0].count, 2u);
  EXPECT_TRUE(state->jobs[0].blames[1].blame.death);
  ASSERT_TRUE(store->apply({DropJob{"j1"}}).ok());
  EXPECT_TRUE(store->load()->jobs.empty());
  ASSERT_TRUE(store->apply({PutJob{header()}}).ok());
  EXPECT_TRUE(store->load()->jobs.at(0).blames.empty());
}

TEST_F(SqliteStoreTest, ADroppedResultLeavesItsEpoch) {
  const auto store = open();
  const LeaseId lease{"j1", 0, 4};
  ASSERT_TRUE(
      store->apply({PutJob{header()}, PutResult{lease, Digest(64, 'c'), {}, "w"}, DropResult{lease}}).ok());
  const auto state = store->load();
  EXPECT_TRUE(state->jobs.at(0).results.empty());
  EXPECT_EQ(state->jobs[0].leases.at(0).lease, lease);
  EXPECT_EQ(state->jobs[0].leases[0].holder.worker, "");
}

TEST_F(SqliteStoreTest, TheLogIsCopiedWhileNothingWaits) {
  const auto store = open();
  const auto log_bytes = [&] { return fs::file_size(path_.string() + "-wal"); };
  for (uint64_t task = 0; task < 1500; ++task)
    ASSERT_TRUE(store->apply({PutResult{{"j1", task, 1}, Digest(64, 'c'), {}, "w"}}).ok());
  const auto before = log_bytes();
  EXPECT_GT(before, 4u << 20) << "nothing but rest() copies it";
  ASSERT_TRUE(store->rest().ok());
  for (uint64_t task = 2000; task < 2500; ++task)
    ASSERT_TRUE(store->apply({PutResult{{"j1", task, 1}, Digest(64, 'c'), {}, "w"}}).ok());
  EXPECT_EQ(log_bytes(), before) << "it was not written anew from its start";
}

TEST_F(SqliteStoreTest, AFileThatIsNotOursIsRefused) {
  std::ofstream(path_) << "certainly not a database, but long enough to look at";
  EXPECT_TRUE(absl::IsInvalidArgument(open_sqlite_store(path_).status()));
  EXPECT_TRUE(absl::IsInvalidArgument(open_sqlite_store("/nonexistent/folder/x").status()));
}

}  // namespace
}  // namespace penumbra
