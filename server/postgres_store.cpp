#include "server/postgres_store.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <iterator>
#include <map>
#include <memory>
#include <string_view>
#include <thread>

#include "proto/status.h"
#include "server/postgres.h"
#include "server/stored_job.h"

namespace penumbra {
namespace {

// Who holds it leads. Any number will do that no other program in this database uses.
constexpr const char* kTryToLead = "SELECT pg_try_advisory_lock(5784101973215)::int::bigint";
constexpr std::chrono::milliseconds kBetweenTries{500};

// A host that has vanished keeps its lock until the database notices: within 3 + 3 x 1 s.
constexpr const char* kSession[] = {"SET tcp_keepalives_idle = 3", "SET tcp_keepalives_interval = 1",
                                    "SET tcp_keepalives_count = 3", "SET client_min_messages = warning"};

// As in sqlite_store.cpp: statement i takes a database from version i to i + 1.
constexpr const char* kMigrations[] = {
    R"sql(
  CREATE TABLE jobs (number BIGSERIAL PRIMARY KEY, id BYTEA UNIQUE NOT NULL, header BYTEA NOT NULL);
  CREATE TABLE leases (job BYTEA NOT NULL, task BIGINT NOT NULL, epoch BIGINT NOT NULL,
    worker BYTEA NOT NULL, host BYTEA NOT NULL, name BYTEA NOT NULL, PRIMARY KEY (job, task));
  CREATE TABLE results (job BYTEA NOT NULL, task BIGINT NOT NULL, epoch BIGINT NOT NULL,
    result BYTEA NOT NULL, costs BYTEA NOT NULL, worker BYTEA NOT NULL, PRIMARY KEY (job, task));
  CREATE TABLE workers (id BYTEA PRIMARY KEY, info BYTEA NOT NULL);
  CREATE TABLE blames (job BYTEA NOT NULL, task BIGINT NOT NULL, who BYTEA NOT NULL, death BIGINT NOT NULL,
    count BIGINT NOT NULL, PRIMARY KEY (job, task, who, death));
  CREATE TABLE logs (job BYTEA NOT NULL, task BIGINT NOT NULL, epoch BIGINT NOT NULL, worker BYTEA NOT NULL,
    time BIGINT NOT NULL, log BYTEA NOT NULL, PRIMARY KEY (job, task, epoch));
)sql",
};
constexpr uint64_t kSchema = std::size(kMigrations);

struct Prepared {
  const char* name;
  const char* sql;
};
constexpr Prepared kPrepared[] = {
    {"put_job", "INSERT INTO jobs(id, header) VALUES($1, $2) ON CONFLICT(id) DO UPDATE SET header = $2"},
    {"put_lease",
     "INSERT INTO leases VALUES($1, $2, $3, $4, $5, $6) ON CONFLICT(job, task) DO UPDATE SET epoch = $3, "
     "worker = "
     "$4, host = $5, name = $6"},
    {"drop_lease", "UPDATE leases SET worker = '' WHERE job = $1 AND task = $2 AND epoch = $3"},
    {"forget_lease", "DELETE FROM leases WHERE job = $1 AND task = $2"},
    // A second result of a task would break "accepted once": let the statement fail, not the law.
    {"put_result", "INSERT INTO results VALUES($1, $2, $3, $4, $5, $6)"},
    {"drop_result", "DELETE FROM results WHERE job = $1 AND task = $2"},
    {"put_blame",
     "INSERT INTO blames VALUES($1, $2, $3, $4, 1) ON CONFLICT(job, task, who, death) DO UPDATE SET count = "
     "blames.count + 1"},
    {"put_log",
     "INSERT INTO logs VALUES($1, $2, $3, $4, $5, $6) ON CONFLICT(job, task, epoch) DO UPDATE SET worker = "
     "$4, time "
     "= $5, log = $6"},
    {"put_worker", "INSERT INTO workers VALUES($1, $2) ON CONFLICT(id) DO UPDATE SET info = $2"},
    {"drop_job", "DELETE FROM jobs WHERE id = $1"},
    {"drop_leases", "DELETE FROM leases WHERE job = $1"},
    {"drop_results", "DELETE FROM results WHERE job = $1"},
    {"drop_blames", "DELETE FROM blames WHERE job = $1"},
    {"drop_logs", "DELETE FROM logs WHERE job = $1"},
};

PgParameters of(const LeaseId& lease) {
  return PgParameters().bytes(lease.job).number(lease.task).number(lease.epoch);
}

class PostgresStore final : public JobStore {
 public:
  explicit PostgresStore(PgConnection connection)
      : connection_(std::move(connection)), db_(connection_.get()) {}

  absl::Status become_leader(const std::function<bool()>& give_up) {
    for (const char* setting : kSession) RETURN_IF_ERROR(db_.execute(setting));
    for (bool told = false;; std::this_thread::sleep_for(kBetweenTries)) {
      ASSIGN_OR_RETURN(const PgRows held, db_.query(kTryToLead));
      if (held.number(0, 0) == 1) break;
      if (give_up()) return absl::CancelledError("stopped while another server leads");
      if (!std::exchange(told, true)) spdlog::info("standing by: another server leads");
    }
    RETURN_IF_ERROR(bring_up_to_date());
    ASSIGN_OR_RETURN(const PgRows epoch,
                     db_.query("UPDATE meta SET value = value + 1 WHERE key = 'epoch' RETURNING value"));
    epoch_ = epoch.number(0, 0);
    for (const Prepared& statement : kPrepared) RETURN_IF_ERROR(db_.prepare(statement.name, statement.sql));
    spdlog::info("leading, epoch {}", epoch_);
    return absl::OkStatus();
  }

  absl::Status be_durable(Durability durability) {
    return db_.execute(durability == Durability::kPowerLoss ? "SET synchronous_commit = on"
                                                            : "SET synchronous_commit = off");
  }

  absl::Status apply(const std::vector<Change>& changes) override {
    RETURN_IF_ERROR(begin());
    absl::Status status;
    for (const Change& change : changes) {
      status = std::visit([&](const auto& c) { return write(c); }, change);
      if (!status.ok()) break;
    }
    const absl::Status sent = db_.finish_sent();
    if (status.ok()) status = sent;
    if (status.ok()) return db_.execute("COMMIT");
    (void)db_.execute("ROLLBACK");
    return status;
  }

  /// Idle, a leader that is none any more must notice too: its callers should find the other.
  absl::Status rest() override {
    if (const absl::Status status = begin(); !status.ok())
      return make_status(absl::StatusCode::kAborted, "{}", message_of(status));
    return db_.execute("COMMIT");
  }

  absl::StatusOr<StoredState> load() override {
    StoredState state;
    std::map<JobId, size_t> number;
    ASSIGN_OR_RETURN(const PgRows jobs, db_.query("SELECT id, header FROM jobs ORDER BY number"));
    for (int i = 0; i < jobs.count(); ++i) {
      absl::StatusOr<JobHeader> header = parse_header(jobs.bytes(i, 1));
      if (!header.ok()) {
        state.unreadable.emplace_back(jobs.bytes(i, 0), message_of(header.status()));
        continue;
      }
      number[header->id] = state.jobs.size();
      state.jobs.push_back({*std::move(header), {}, {}, {}});
    }
    const auto job_of = [&](const PgRows& rows, int i) -> StoredJob* {
      const auto it = number.find(rows.bytes(i, 0));
      return it == number.end() ? nullptr : &state.jobs[it->second];
    };
    ASSIGN_OR_RETURN(const PgRows leases, db_.query("SELECT * FROM leases"));
    for (int i = 0; i < leases.count(); ++i)
      if (StoredJob* job = job_of(leases, i))
        job->leases.push_back({{leases.bytes(i, 0), leases.number(i, 1), leases.number(i, 2)},
                               {leases.bytes(i, 3), leases.bytes(i, 4), leases.bytes(i, 5)}});
    ASSIGN_OR_RETURN(const PgRows results, db_.query("SELECT * FROM results ORDER BY job, task"));
    for (int i = 0; i < results.count(); ++i) {
      StoredJob* job = job_of(results, i);
      if (job == nullptr) continue;
      ASSIGN_OR_RETURN(std::vector<MixCost> costs, parse_costs(results.bytes(i, 4)));
      job->results.push_back({{results.bytes(i, 0), results.number(i, 1), results.number(i, 2)},
                              results.bytes(i, 3),
                              std::move(costs),
                              results.bytes(i, 5)});
    }
    ASSIGN_OR_RETURN(const PgRows blames, db_.query("SELECT * FROM blames"));
    for (int i = 0; i < blames.count(); ++i)
      if (StoredJob* job = job_of(blames, i))
        job->blames.push_back(
            {{blames.bytes(i, 0), blames.number(i, 1), blames.bytes(i, 2), blames.number(i, 3) != 0},
             blames.number(i, 4)});
    ASSIGN_OR_RETURN(const PgRows workers, db_.query("SELECT info FROM workers"));
    for (int i = 0; i < workers.count(); ++i) {
      ASSIGN_OR_RETURN(WorkerInfo worker, parse_worker(workers.bytes(i, 0)));
      state.workers.push_back(std::move(worker));
    }
    return state;
  }

  absl::StatusOr<std::vector<PutLog>> logs(const JobId& job, uint64_t modulus, uint64_t remainder,
                                           size_t most_bytes) override {
    ASSIGN_OR_RETURN(
        const PgRows rows,
        db_.query(
            "SELECT task, epoch, worker, time, log FROM (SELECT *, SUM(length(log)) OVER (ORDER BY time "
            "DESC, task, epoch) AS bytes FROM logs WHERE job = $1 AND task % $2::bigint = $3::bigint) AS "
            "latest WHERE bytes <= $4::bigint ORDER BY time DESC, task, epoch",
            PgParameters().bytes(job).number(modulus).number(remainder).number(most_bytes)));
    std::vector<PutLog> found;
    for (int i = rows.count(); i-- > 0;)
      found.push_back({{job, rows.number(i, 0), rows.number(i, 1)},
                       rows.bytes(i, 2),
                       1e-6 * static_cast<double>(rows.number(i, 3)),
                       rows.bytes(i, 4)});
    return found;
  }

 private:
  absl::Status bring_up_to_date() {
    RETURN_IF_ERROR(
        db_.execute("CREATE TABLE IF NOT EXISTS meta (key TEXT PRIMARY KEY, value BIGINT NOT NULL)"));
    RETURN_IF_ERROR(db_.execute("INSERT INTO meta VALUES('schema', 0), ('epoch', 0) ON CONFLICT DO NOTHING"));
    ASSIGN_OR_RETURN(const PgRows version, db_.query("SELECT value FROM meta WHERE key = 'schema'"));
    if (version.number(0, 0) > kSchema)
      return invalid_input("its schema {} is newer than this program's {}", version.number(0, 0), kSchema);
    for (uint64_t step = version.number(0, 0); step < kSchema; ++step) {
      RETURN_IF_ERROR(db_.execute("BEGIN"));
      RETURN_IF_ERROR(db_.execute(kMigrations[step]));
      RETURN_IF_ERROR(db_.execute("UPDATE meta SET value = value + 1 WHERE key = 'schema'"));
      RETURN_IF_ERROR(db_.execute("COMMIT"));
    }
    return absl::OkStatus();
  }

  /// The epoch's row stays locked until the end: a new leader waits for a commit that is under way, and one
  /// of a former leader finds another number.
  absl::Status begin() {
    RETURN_IF_ERROR(db_.execute("BEGIN"));
    const absl::StatusOr<PgRows> epoch = db_.query("SELECT value FROM meta WHERE key = 'epoch' FOR SHARE");
    if (epoch.ok() && epoch->number(0, 0) == epoch_) return absl::OkStatus();
    (void)db_.execute("ROLLBACK");
    if (!epoch.ok()) return epoch.status();
    return make_status(absl::StatusCode::kAborted, "job store: another server leads: epoch {}, not {}",
                       epoch->number(0, 0), epoch_);
  }

  absl::Status write(const PutJob& put) {
    return db_.send("put_job", PgParameters().bytes(put.job.id).bytes(serialize_header(put.job)));
  }
  absl::Status write(const PutLease& put) {
    return db_.send("put_lease",
                    of(put.lease).bytes(put.holder.worker).bytes(put.holder.host).bytes(put.holder.name));
  }
  absl::Status write(const DropLease& drop) { return db_.send("drop_lease", of(drop.lease)); }
  absl::Status write(const PutResult& put) {
    RETURN_IF_ERROR(db_.send("forget_lease", PgParameters().bytes(put.lease.job).number(put.lease.task)));
    return db_.send("put_result",
                    of(put.lease).bytes(put.result).bytes(serialize_costs(put.costs)).bytes(put.worker));
  }
  absl::Status write(const DropResult& drop) {
    RETURN_IF_ERROR(db_.send("drop_result", PgParameters().bytes(drop.lease.job).number(drop.lease.task)));
    return write(PutLease{drop.lease, {}});
  }
  absl::Status write(const PutBlame& put) {
    return db_.send("put_blame", PgParameters().bytes(put.job).number(put.task).bytes(put.who).number(
                                     uint64_t{put.death}));
  }
  absl::Status write(const PutLog& put) {
    return db_.send(
        "put_log",
        of(put.lease).bytes(put.worker).number(static_cast<uint64_t>(1e6 * put.unix_time)).bytes(put.text));
  }
  absl::Status write(const DropJob& drop) {
    for (const char* statement : {"drop_job", "drop_leases", "drop_results", "drop_blames", "drop_logs"})
      RETURN_IF_ERROR(db_.send(statement, PgParameters().bytes(drop.job)));
    return absl::OkStatus();
  }
  absl::Status write(const PutWorker& put) {
    return db_.send("put_worker", PgParameters().bytes(put.worker.id).bytes(serialize_worker(put.worker)));
  }

  PgConnection connection_;
  PgStatements db_;
  uint64_t epoch_ = 0;
};

/// A URL that libpq can read, without a password: command lines are no secret. libpq's own words about a URL
/// repeat it whole, so they are not passed on.
absl::Status check_url(const std::string& url) {
  const std::unique_ptr<PQconninfoOption, decltype(&PQconninfoFree)> options(
      PQconninfoParse(url.c_str(), nullptr), PQconninfoFree);
  if (!options) return invalid_input("--database: not a PostgreSQL URL");
  for (const PQconninfoOption* option = options.get(); option->keyword != nullptr; ++option)
    if (std::string_view(option->keyword) == "password" && option->val != nullptr)
      return invalid_input("--database: a password does not belong on a command line; see PGPASSFILE");
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<std::unique_ptr<JobStore>> open_postgres_store(const std::string& url, Durability durability,
                                                              const std::function<bool()>& give_up) {
  RETURN_IF_ERROR(check_url(url));
  // On this side as well: a leader that the network has cut off must not wait for its database for minutes.
  const char* const keys[] = {"dbname",
                              "connect_timeout",
                              "tcp_user_timeout",
                              "keepalives_idle",
                              "keepalives_interval",
                              "keepalives_count",
                              nullptr};
  const char* const values[] = {url.c_str(), "5", "5000", "3", "1", "3", nullptr};
  PgConnection connection(PQconnectdbParams(keys, values, 1));
  if (PQstatus(connection.get()) != CONNECTION_OK)
    return make_status(absl::StatusCode::kUnavailable, "--database: {}", PQerrorMessage(connection.get()));
  auto store = std::make_unique<PostgresStore>(std::move(connection));
  if (const absl::Status status = store->become_leader(give_up); !status.ok())
    return absl::IsCancelled(status) ? status
                                     : make_status(status.code(), "--database: {}", message_of(status));
  RETURN_IF_ERROR(store->be_durable(durability));
  return std::unique_ptr<JobStore>(std::move(store));
}

}  // namespace penumbra
