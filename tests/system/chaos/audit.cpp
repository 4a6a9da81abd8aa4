#include "tests/system/chaos/audit.h"

#include <fmt/format.h>
#include <sqlite3.h>

#include <filesystem>
#include <functional>
#include <memory>

#include "proto/blob_folder.h"

namespace penumbra {
namespace {

using Row = std::vector<std::string>;

std::vector<Row> rows(sqlite3* db, const std::string& sql, std::vector<std::string>& faults) {
  std::vector<Row> out;
  char* message = nullptr;
  const auto take = [](void* to, int columns, char** values, char**) {
    Row row;
    for (int i = 0; i < columns; ++i) row.emplace_back(values[i] == nullptr ? "" : values[i]);
    static_cast<std::vector<Row>*>(to)->push_back(std::move(row));
    return 0;
  };
  if (sqlite3_exec(db, sql.c_str(), take, &out, &message) != SQLITE_OK)
    faults.push_back(fmt::format("{}: {}", sql, message));
  sqlite3_free(message);
  return out;
}

uint64_t number(sqlite3* db, const std::string& sql, std::vector<std::string>& faults) {
  const std::vector<Row> found = rows(db, sql, faults);
  return found.empty() || found[0][0].empty() ? 0 : std::stoull(found[0][0]);
}

void audit_job(sqlite3* db, const JobStatus& job, uint64_t pilots, std::vector<std::string>& faults) {
  const std::string where = fmt::format(" WHERE job = '{}'", job.job);
  const auto expect = [&](const char* what, uint64_t found, uint64_t wanted) {
    if (found != wanted)
      faults.push_back(
          fmt::format("job {}: {}: the database says {}, the server {}", job.job, what, found, wanted));
  };
  const uint64_t results = number(db, "SELECT count(*) FROM results" + where, faults);
  const uint64_t tasks = number(db, "SELECT count(DISTINCT task) FROM results" + where, faults);
  const uint64_t last = number(db, "SELECT max(task) + 1 FROM results" + where, faults);
  expect("results and tasks with one", results, tasks);
  if (job.state == JobState::kDone) {
    expect("accepted tasks", results, job.tasks_total + pilots);
    expect("the number after the last task", last, job.tasks_total + pilots);
  }
  expect("tasks done", results, job.tasks_done + pilots);
  expect("leases in somebody's hands",
         number(db, "SELECT count(*) FROM leases" + where + " AND worker != ''", faults), 0);
  expect("retries",
         number(db,
                "SELECT (SELECT coalesce(sum(epoch - 1), 0) FROM results" + where +
                    ") + (SELECT coalesce(sum(epoch - 1), 0) FROM leases" + where + ")",
                faults),
         job.retries);
}

}  // namespace

std::vector<std::string> audit(const std::string& store, const std::vector<JobStatus>& jobs) {
  std::vector<std::string> faults;
  sqlite3* raw = nullptr;
  const int code = sqlite3_open((store + "/jobs.sqlite").c_str(), &raw);
  const std::unique_ptr<sqlite3, int (*)(sqlite3*)> db(raw, sqlite3_close);
  if (code != SQLITE_OK) return {"the database cannot be opened"};
  if (rows(db.get(), "PRAGMA integrity_check", faults) != std::vector<Row>{{"ok"}})
    faults.push_back("the database is not whole");
  const uint64_t kept = number(db.get(), "SELECT count(*) FROM jobs", faults);
  if (kept != jobs.size())
    faults.push_back(fmt::format("{} jobs in the database, {} known", kept, jobs.size()));
  for (const JobStatus& job : jobs) audit_job(db.get(), job, 0, faults);

  const auto blobs = BlobFolder::open(store + "/blobs");
  if (!blobs.ok()) return {"the blobs cannot be opened"};
  for (const JobStatus& job : jobs) {
    if (job.state != JobState::kDone) continue;
    const std::string sql = fmt::format("SELECT DISTINCT result FROM results WHERE job = '{}'", job.job);
    for (const Row& row : rows(db.get(), sql, faults))
      if (!blobs->verify(row[0]).ok())
        faults.push_back(fmt::format("job {}: result {} is not whole", job.job, row[0]));
  }
  return faults;
}

}  // namespace penumbra
