#pragma once
// Who renders what, and until when. Pure: no threads, disk, network or clock; time is passed in, changes
// to be stored are handed out. The coordinator stores them before it lets any answer leave.
//
// Laws
//   * A result is accepted once per task, from the holder of the task's latest lease (job, task, epoch).
//   * A worker that has been silent for `silence` seconds loses its leases; a new incarnation of the same
//     (host, name) ends the old one's at once.
//   * A scene at fault fails its job at once; a task that fails on several workers fails its job with the
//     reason; nothing is tried for ever.
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "proto/run.h"
#include "proto/sync.h"
#include "server/changes.h"
#include "server/job_record.h"

namespace penumbra {

struct SchedulerLimits {
  double silence_seconds = 10;   ///< after which a worker has lost its leases
  size_t failing_workers = 3;    ///< that report failure of one task: its job fails
  int failures = 5;              ///< reports in all, for clusters with fewer workers
  size_t deaths = 5;             ///< workers that died while rendering one task
  double retired_seconds = 600;  ///< how long a replaced incarnation is remembered
};

/// What the bytes of a result hold, found out by whoever could read them.
struct ResultShape {
  PixelRect rect;
  std::vector<int64_t> passes;  ///< per mix
};

/// Answer to a Sync, and whether it says anything that is worth sending before the worker's wait is over.
struct SyncAnswer {
  DesiredState desired;
  bool urgent = false;
};

/// A worker as `explain` and the dashboard see it.
struct WorkerRecord {
  WorkerInfo info;
  std::string name, version;
  double last_seen = 0;  ///< Now::steady
  double process_cpu_seconds = 0;
  bool draining = false;
  bool contributed = false;                               ///< the store knows it
  std::map<std::pair<JobId, uint64_t>, uint64_t> leases;  ///< (job, task) -> epoch
};

class Scheduler {
 public:
  explicit Scheduler(SchedulerLimits limits = {}) : limits_(limits) {}

  /// Takes over what a store has kept. Workers that held leases have `silence` seconds to call.
  absl::Status restore(const StoredState& stored, const Now& now);

  /// A new job, or the one that was made with the same request id.
  JobId submit(const JobId& id, const std::string& request_id, const JobSpec& spec, const Now& now);
  /// NotFound for an unknown job. A final job stays what it is.
  absl::Status cancel(const JobId& id, const Now& now);

  /// Takes a worker's report. `shapes` are parallel to state.completed: what the result's bytes hold;
  /// NotFound if the blob is not here (the result is not acknowledged: the worker uploads it again), any
  /// other error if it is unusable (counts as a failure). Ignored for pilots.
  /// FailedPrecondition: a newer incarnation of this worker is at work.
  absl::Status report(const WorkerState& state, const std::vector<absl::StatusOr<ResultShape>>& shapes,
                      const Now& now);
  /// Grants leases and says what the worker should have. After report() with the same state; may be
  /// repeated later while the worker waits.
  SyncAnswer answer(const WorkerState& state, const Now& now);

  /// Ends the leases of silent workers.
  void expire(const Now& now);
  /// When expire() will next have something to do, Now::steady; none without workers.
  std::optional<double> next_expiry() const;

  /// Changes since the last call, in order.
  std::vector<Change> take_changes();
  /// Grows whenever something happened that may interest a waiting worker or watcher.
  uint64_t revision() const { return revision_; }

  const std::map<JobId, std::unique_ptr<JobRecord>>& jobs() const { return jobs_; }
  const std::map<std::string, WorkerRecord>& workers() const { return workers_; }
  /// Every worker that has contributed a result, by incarnation.
  const std::map<std::string, WorkerInfo>& contributors() const { return contributors_; }
  const JobRecord* find(const JobId& id) const;

 private:
  using Identity = std::pair<std::string, std::string>;  // host, name

  JobRecord* find_job(const JobId& id);
  absl::StatusOr<WorkerRecord*> meet(const WorkerState& state, const Now& now);
  void complete(WorkerRecord& worker, const CompletedTask& task, const absl::StatusOr<ResultShape>& shape,
                const Now& now);
  void fail(WorkerRecord& worker, const FailedTask& task, const Now& now);
  void take_load(const LoadedScene& scene);
  void blame_failure(JobRecord& job, uint64_t task, const WorkerRecord& worker, const std::string& message,
                     const Now& now);
  void end_lease(WorkerRecord& worker, JobRecord& job, uint64_t task);
  void end_worker(const std::string& id, const Now& now);
  void advance(JobRecord& job, const Now& now);
  void finish(JobRecord& job, JobState state, FailureKind failure, std::string message, const Now& now);
  void grant(WorkerRecord& worker, uint32_t wanted, const Now& now);
  uint64_t pending() const;
  int cores() const;
  void put(Change change);

  SchedulerLimits limits_;
  std::map<JobId, std::unique_ptr<JobRecord>> jobs_;
  std::vector<JobId> order_;  ///< of submission; final jobs leave it
  std::map<std::string, JobId> requests_;
  std::map<std::string, WorkerRecord> workers_;
  std::map<Identity, std::string> incarnations_;
  std::map<std::string, double> retired_;  ///< incarnation -> when it was replaced
  std::map<std::string, WorkerInfo> contributors_;
  std::vector<Change> changes_;
  uint64_t revision_ = 0;
};

}  // namespace penumbra
