#include "server/sqlite_store.h"

#include <algorithm>
#include <iterator>
#include <map>

#include "server/sqlite.h"
#include "server/stored_job.h"

namespace penumbra {
namespace {

// Pages of the write-ahead log after which it is copied into the database: while nothing waits, and in any
// case before it has grown to the second.
constexpr int kCheckpointPages = 1000, kMostPages = 16'000;

// The schema's history: statement i takes a database from version i to i + 1, so a new one runs them all and
// an old one those that it lacks. A statement that has been released is never changed.
//
// A lease row outlives its lease (worker = ''), because the epoch fences late results; it goes when the
// task's result is accepted, which keeps the epoch itself.
constexpr const char* kMigrations[] = {
    R"sql(
  CREATE TABLE jobs (number INTEGER PRIMARY KEY, id TEXT UNIQUE NOT NULL, header BLOB NOT NULL);
  CREATE TABLE leases (job TEXT NOT NULL, task INTEGER NOT NULL, epoch INTEGER NOT NULL,
    worker TEXT NOT NULL, host TEXT NOT NULL, name TEXT NOT NULL, PRIMARY KEY (job, task)) WITHOUT ROWID;
  CREATE TABLE results (job TEXT NOT NULL, task INTEGER NOT NULL, epoch INTEGER NOT NULL,
    result TEXT NOT NULL, costs BLOB NOT NULL, worker TEXT NOT NULL, PRIMARY KEY (job, task)) WITHOUT ROWID;
  CREATE TABLE workers (id TEXT PRIMARY KEY, info BLOB NOT NULL) WITHOUT ROWID;
)sql",
    // Failures count over restarts.
    R"sql(
  CREATE TABLE blames (job TEXT NOT NULL, task INTEGER NOT NULL, who TEXT NOT NULL, death INTEGER NOT NULL,
    count INTEGER NOT NULL, PRIMARY KEY (job, task, who, death)) WITHOUT ROWID;
)sql",
    // What workers logged; when, in microseconds since 1970.
    R"sql(
  CREATE TABLE logs (job TEXT NOT NULL, task INTEGER NOT NULL, epoch INTEGER NOT NULL, worker TEXT NOT NULL,
    time INTEGER NOT NULL, log TEXT NOT NULL, PRIMARY KEY (job, task, epoch)) WITHOUT ROWID;
)sql",
    // The latest are read without sorting all of them.
    "CREATE INDEX logs_by_time ON logs(job, time);",
};
constexpr uint64_t kSchema = std::size(kMigrations);

struct CloseDatabase {
  void operator()(sqlite3* db) const { sqlite3_close_v2(db); }
};
using Database = std::unique_ptr<sqlite3, CloseDatabase>;

class SqliteStore final : public JobStore {
 public:
  explicit SqliteStore(Database db) : db_(std::move(db)) {}

  absl::Status prepare() {
    const auto make = [&](std::unique_ptr<Statement>& into, std::string_view sql) -> absl::Status {
      ASSIGN_OR_RETURN(Statement statement, Statement::prepare(db_.get(), sql));
      into = std::make_unique<Statement>(std::move(statement));
      return absl::OkStatus();
    };
    RETURN_IF_ERROR(make(put_job_,
                         "INSERT INTO jobs(id, header) VALUES(?1, ?2) "
                         "ON CONFLICT(id) DO UPDATE SET header = ?2"));
    RETURN_IF_ERROR(make(put_lease_, "INSERT OR REPLACE INTO leases VALUES(?, ?, ?, ?, ?, ?)"));
    RETURN_IF_ERROR(
        make(drop_lease_, "UPDATE leases SET worker = '' WHERE job = ? AND task = ? AND epoch = ?"));
    RETURN_IF_ERROR(make(forget_lease_, "DELETE FROM leases WHERE job = ? AND task = ?"));
    // A second result of a task would break "accepted once": let the statement fail, not the law.
    RETURN_IF_ERROR(make(put_result_, "INSERT INTO results VALUES(?, ?, ?, ?, ?, ?)"));
    RETURN_IF_ERROR(make(put_blame_,
                         "INSERT INTO blames VALUES(?, ?, ?, ?, 1) "
                         "ON CONFLICT(job, task, who, death) DO UPDATE SET count = count + 1"));
    for (size_t i = 0; i < std::size(kOfJobs); ++i) RETURN_IF_ERROR(make(drop_job_[i], kOfJobs[i]));
    sqlite3_wal_hook(
        db_.get(),
        [](void* self, sqlite3*, const char*, int pages) {
          static_cast<SqliteStore*>(self)->log_pages_ = pages;
          return SQLITE_OK;
        },
        this);
    RETURN_IF_ERROR(make(drop_result_, "DELETE FROM results WHERE job = ? AND task = ?"));
    RETURN_IF_ERROR(make(put_log_, "INSERT OR REPLACE INTO logs VALUES(?, ?, ?, ?, ?, ?)"));
    return make(put_worker_, "INSERT OR REPLACE INTO workers VALUES(?, ?)");
  }

  absl::Status apply(const std::vector<Change>& changes) override {
    RETURN_IF_ERROR(execute(db_.get(), "BEGIN IMMEDIATE"));
    for (const Change& change : changes) {
      const absl::Status status = std::visit([&](const auto& c) { return write(c); }, change);
      if (status.ok()) continue;
      sqlite3_exec(db_.get(), "ROLLBACK", nullptr, nullptr, nullptr);
      return status;
    }
    const absl::Status status = execute(db_.get(), "COMMIT");
    if (!status.ok()) sqlite3_exec(db_.get(), "ROLLBACK", nullptr, nullptr, nullptr);
    if (status.ok() && log_pages_ >= kMostPages) return checkpoint();
    return status;
  }

  absl::StatusOr<std::vector<PutLog>> logs(const JobId& job, uint64_t modulus, uint64_t remainder,
                                           size_t most_bytes) override {
    ASSIGN_OR_RETURN(
        Statement row,
        Statement::prepare(db_.get(),
                           "SELECT task, epoch, worker, time, log FROM logs WHERE job = ? AND task % ? "
                           "= ? ORDER BY time DESC"));
    row.bind(job).bind(modulus).bind(remainder);
    std::vector<PutLog> found;
    for (size_t bytes = 0;;) {
      ASSIGN_OR_RETURN(const bool more, row.step());
      if (!more) break;
      bytes += row.text(4).size();
      if (bytes > most_bytes) break;
      found.push_back({{job, row.number(0), row.number(1)},
                       row.text(2),
                       1e-6 * static_cast<double>(row.number(3)),
                       row.text(4)});
    }
    std::reverse(found.begin(), found.end());
    return found;
  }

  absl::Status rest() override { return log_pages_ >= kCheckpointPages ? checkpoint() : absl::OkStatus(); }

  absl::StatusOr<StoredState> load() override {
    StoredState state;
    std::map<JobId, size_t> number;
    RETURN_IF_ERROR(each("SELECT id, header FROM jobs ORDER BY number", [&](Statement& row) -> absl::Status {
      absl::StatusOr<JobHeader> header = parse_header(row.text(1));
      if (!header.ok()) {
        state.unreadable.emplace_back(row.text(0), message_of(header.status()));
        return absl::OkStatus();
      }
      number[header->id] = state.jobs.size();
      state.jobs.push_back({*std::move(header), {}, {}});
      return absl::OkStatus();
    }));
    RETURN_IF_ERROR(each("SELECT * FROM leases", [&](Statement& row) -> absl::Status {
      if (number.contains(row.text(0)))
        state.jobs[number[row.text(0)]].leases.push_back(
            {{row.text(0), row.number(1), row.number(2)}, {row.text(3), row.text(4), row.text(5)}});
      return absl::OkStatus();
    }));
    RETURN_IF_ERROR(each("SELECT * FROM results ORDER BY job, task", [&](Statement& row) -> absl::Status {
      if (!number.contains(row.text(0))) return absl::OkStatus();
      ASSIGN_OR_RETURN(std::vector<MixCost> costs, parse_costs(row.text(4)));
      state.jobs[number[row.text(0)]].results.push_back(
          {{row.text(0), row.number(1), row.number(2)}, row.text(3), std::move(costs), row.text(5)});
      return absl::OkStatus();
    }));
    RETURN_IF_ERROR(each("SELECT * FROM blames", [&](Statement& row) -> absl::Status {
      if (number.contains(row.text(0)))
        state.jobs[number[row.text(0)]].blames.push_back(
            {{row.text(0), row.number(1), row.text(2), row.number(3) != 0}, row.number(4)});
      return absl::OkStatus();
    }));
    RETURN_IF_ERROR(each("SELECT info FROM workers", [&](Statement& row) -> absl::Status {
      ASSIGN_OR_RETURN(WorkerInfo worker, parse_worker(row.text(0)));
      state.workers.push_back(std::move(worker));
      return absl::OkStatus();
    }));
    return state;
  }

 private:
  template <class Visit>
  absl::Status each(std::string_view sql, Visit visit) {
    ASSIGN_OR_RETURN(Statement statement, Statement::prepare(db_.get(), sql));
    for (;;) {
      ASSIGN_OR_RETURN(const bool row, statement.step());
      if (!row) return absl::OkStatus();
      RETURN_IF_ERROR(visit(statement));
    }
  }

  absl::Status write(const PutJob& put) {
    return put_job_->bind(put.job.id).bind_blob(serialize_header(put.job)).run();
  }
  absl::Status write(const PutLease& put) {
    put_lease_->bind(put.lease.job).bind(put.lease.task).bind(put.lease.epoch);
    return put_lease_->bind(put.holder.worker).bind(put.holder.host).bind(put.holder.name).run();
  }
  absl::Status write(const DropLease& drop) {
    return drop_lease_->bind(drop.lease.job).bind(drop.lease.task).bind(drop.lease.epoch).run();
  }
  absl::Status write(const PutResult& put) {
    RETURN_IF_ERROR(forget_lease_->bind(put.lease.job).bind(put.lease.task).run());
    put_result_->bind(put.lease.job).bind(put.lease.task).bind(put.lease.epoch).bind(put.result);
    return put_result_->bind_blob(serialize_costs(put.costs)).bind(put.worker).run();
  }
  absl::Status write(const DropResult& drop) {
    RETURN_IF_ERROR(drop_result_->bind(drop.lease.job).bind(drop.lease.task).run());
    return write(PutLease{drop.lease, {}});
  }
  absl::Status write(const PutBlame& put) {
    return put_blame_->bind(put.job).bind(put.task).bind(put.who).bind(uint64_t{put.death}).run();
  }
  absl::Status write(const PutLog& put) {
    put_log_->bind(put.lease.job).bind(put.lease.task).bind(put.lease.epoch).bind(put.worker);
    return put_log_->bind(static_cast<uint64_t>(1e6 * put.unix_time)).bind(put.text).run();
  }
  absl::Status write(const DropJob& drop) {
    for (const auto& statement : drop_job_) RETURN_IF_ERROR(statement->bind(drop.job).run());
    return absl::OkStatus();
  }
  absl::Status write(const PutWorker& put) {
    return put_worker_->bind(put.worker.id).bind_blob(serialize_worker(put.worker)).run();
  }

  /// The log's pages go into the database, which makes room to write the log anew from its start. Nobody
  /// reads beside this thread, so none can be held up.
  absl::Status checkpoint() {
    if (sqlite3_wal_checkpoint_v2(db_.get(), nullptr, SQLITE_CHECKPOINT_RESTART, nullptr, nullptr) !=
        SQLITE_OK)
      return sqlite_error(db_.get(), "checkpoint");
    log_pages_ = 0;
    return absl::OkStatus();
  }

  static constexpr const char* kOfJobs[] = {
      "DELETE FROM jobs WHERE id = ?", "DELETE FROM leases WHERE job = ?",
      "DELETE FROM results WHERE job = ?", "DELETE FROM blames WHERE job = ?",
      "DELETE FROM logs WHERE job = ?"};
  int log_pages_ = 0;
  Database db_;  // outlives the statements below
  std::unique_ptr<Statement> put_job_, put_lease_, drop_lease_, forget_lease_, put_result_, drop_result_,
      put_blame_, put_worker_, put_log_;
  std::unique_ptr<Statement> drop_job_[std::size(kOfJobs)];
};

absl::Status make_schema(sqlite3* db, Durability durability) {
  RETURN_IF_ERROR(execute(db, "PRAGMA journal_mode = WAL"));
  RETURN_IF_ERROR(execute(
      db, durability == Durability::kPowerLoss ? "PRAGMA synchronous = FULL" : "PRAGMA synchronous = OFF"));
  ASSIGN_OR_RETURN(Statement version, Statement::prepare(db, "PRAGMA user_version"));
  ASSIGN_OR_RETURN(const bool row, version.step());
  const uint64_t found = row ? version.number(0) : 0;
  if (found > kSchema)
    return invalid_input("job store: its schema {} is newer than this program's {}", found, kSchema);
  for (uint64_t step = found; step < kSchema; ++step) {
    RETURN_IF_ERROR(execute(db, "BEGIN IMMEDIATE"));
    RETURN_IF_ERROR(execute(db, kMigrations[step]));
    RETURN_IF_ERROR(execute(db, fmt::format("PRAGMA user_version = {}", step + 1).c_str()));
    RETURN_IF_ERROR(execute(db, "COMMIT"));
  }
  // Copying the log is a matter of rest() and apply(), never of whichever commit happens to be the
  // thousandth.
  return execute(db, "PRAGMA wal_autocheckpoint = 0");
}

}  // namespace

absl::StatusOr<std::unique_ptr<JobStore>> open_sqlite_store(const std::string& path, Durability durability) {
  sqlite3* raw = nullptr;
  const int code = sqlite3_open_v2(path.c_str(), &raw, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE, nullptr);
  Database db(raw);
  if (code != SQLITE_OK) return invalid_input("{}: {}", path, sqlite3_errstr(code));
  if (const absl::Status status = make_schema(db.get(), durability); !status.ok())
    return invalid_input("{}: {}", path, message_of(status));
  auto store = std::make_unique<SqliteStore>(std::move(db));
  RETURN_IF_ERROR(store->prepare());
  return std::unique_ptr<JobStore>(std::move(store));
}

}  // namespace penumbra
