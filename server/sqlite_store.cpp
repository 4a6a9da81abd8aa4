#include "server/sqlite_store.h"

#include <map>

#include "server/sqlite.h"
#include "server/stored_job.h"

namespace penumbra {
namespace {

constexpr uint64_t kSchema = 1;

// A lease row outlives its lease (worker = ''), because the epoch fences late results; it goes when the
// task's result is accepted, which keeps the epoch itself.
constexpr const char* kTables = R"sql(
  CREATE TABLE jobs (number INTEGER PRIMARY KEY, id TEXT UNIQUE NOT NULL, header BLOB NOT NULL);
  CREATE TABLE leases (job TEXT NOT NULL, task INTEGER NOT NULL, epoch INTEGER NOT NULL,
    worker TEXT NOT NULL, host TEXT NOT NULL, name TEXT NOT NULL, PRIMARY KEY (job, task)) WITHOUT ROWID;
  CREATE TABLE results (job TEXT NOT NULL, task INTEGER NOT NULL, epoch INTEGER NOT NULL,
    result TEXT NOT NULL, costs BLOB NOT NULL, worker TEXT NOT NULL, PRIMARY KEY (job, task)) WITHOUT ROWID;
  CREATE TABLE workers (id TEXT PRIMARY KEY, info BLOB NOT NULL) WITHOUT ROWID;
  PRAGMA user_version = 1;
)sql";

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
    return status;
  }

  absl::StatusOr<StoredState> load() override {
    StoredState state;
    std::map<JobId, size_t> number;
    RETURN_IF_ERROR(each("SELECT header FROM jobs ORDER BY number", [&](Statement& row) -> absl::Status {
      ASSIGN_OR_RETURN(JobHeader header, parse_header(row.text(0)));
      number[header.id] = state.jobs.size();
      state.jobs.push_back({std::move(header), {}, {}});
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
  absl::Status write(const PutWorker& put) {
    return put_worker_->bind(put.worker.id).bind_blob(serialize_worker(put.worker)).run();
  }

  Database db_;  // outlives the statements below
  std::unique_ptr<Statement> put_job_, put_lease_, drop_lease_, forget_lease_, put_result_, put_worker_;
};

absl::Status make_schema(sqlite3* db) {
  RETURN_IF_ERROR(execute(db, "PRAGMA journal_mode = WAL"));
  RETURN_IF_ERROR(execute(db, "PRAGMA synchronous = FULL"));
  ASSIGN_OR_RETURN(Statement version, Statement::prepare(db, "PRAGMA user_version"));
  ASSIGN_OR_RETURN(const bool row, version.step());
  const uint64_t found = row ? version.number(0) : 0;
  if (found > kSchema)
    return invalid_input("job store: its schema {} is newer than this program's {}", found, kSchema);
  if (found == kSchema) return absl::OkStatus();
  RETURN_IF_ERROR(execute(db, "BEGIN IMMEDIATE"));
  RETURN_IF_ERROR(execute(db, kTables));
  return execute(db, "COMMIT");
}

}  // namespace

absl::StatusOr<std::unique_ptr<JobStore>> open_sqlite_store(const std::string& path) {
  sqlite3* raw = nullptr;
  const int code = sqlite3_open_v2(path.c_str(), &raw, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE, nullptr);
  Database db(raw);
  if (code != SQLITE_OK) return invalid_input("{}: {}", path, sqlite3_errstr(code));
  if (const absl::Status status = make_schema(db.get()); !status.ok())
    return invalid_input("{}: {}", path, message_of(status));
  auto store = std::make_unique<SqliteStore>(std::move(db));
  RETURN_IF_ERROR(store->prepare());
  return std::unique_ptr<JobStore>(std::move(store));
}

}  // namespace penumbra
