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
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "proto/log.h"
#include "proto/run.h"
#include "proto/sync.h"
#include "server/changes.h"
#include "server/job_record.h"

namespace penumbra {

/// What one user may have at a time.
struct UserQuota {
  uint64_t jobs = UINT64_MAX;    ///< unfinished
  uint64_t leases = UINT64_MAX;  ///< tasks in the hands of workers
};

struct SchedulerLimits {
  double silence_seconds = 10;              ///< after which a worker has lost its leases
  size_t failing_workers = 3;               ///< that report failure of one task: its job fails
  int failures = 5;                         ///< reports in all, for clusters with fewer workers
  size_t deaths = 5;                        ///< workers that died while rendering one task
  double task_seconds = 1800;               ///< for one task: a planner's task takes a thousandth of this
  std::map<std::string, UserQuota> quotas;  ///< by user; others have none
  size_t failed_jobs = 3;                   ///< in a row: the worker is at fault, and is set aside
  double retired_seconds = 600;             ///< how long a replaced incarnation is remembered
};

/// What the bytes of a result hold, found out by whoever could read them.
struct ResultShape {
  PixelRect rect;
  std::vector<int64_t> passes;  ///< per mix
  /// Per mix: of each block of pixels (proto/blocks.h); empty, or none of a mix: the mix's passes everywhere.
  std::vector<std::vector<int32_t>> block_passes = {};
  std::vector<int> bins;  ///< per mix
};

/// What an operator may want to read of.
struct Notice {
  About about;
  std::string text;
  bool detail = false;  ///< as happens with every task
};

/// Answer to a Sync, and whether it says anything that is worth sending before the worker's wait is over.
struct SyncAnswer {
  DesiredState desired;
  bool urgent = false;
};

/// A worker as `explain` and the dashboard see it.
struct WorkerRecord {
  /// The same over restarts of the worker.
  std::string identity() const { return info.host + "/" + name; }

  WorkerInfo info;
  std::string name, version;
  double last_seen = 0;  ///< Now::steady
  double process_cpu_seconds = 0;
  bool draining = false;
  bool contributed = false;                               ///< the store knows it
  std::string set_aside;                                  ///< why it gets no more tasks; empty: it does
  std::set<JobId> failed_jobs;                            ///< since its last accepted result
  int failures = 0;                                       ///< in a row
  double rest_until = 0;                                  ///< Now::steady: no new task before
  std::map<std::pair<JobId, uint64_t>, uint64_t> leases;  ///< (job, task) -> epoch
};

class Scheduler {
 public:
  explicit Scheduler(SchedulerLimits limits = {}) : limits_(limits) {}

  /// Takes over what a store has kept. Workers that held leases have `silence` seconds to call.
  absl::Status restore(const StoredState& stored, const Now& now);

  /// A new job, or the one that was made with the same request id.
  JobId submit(const JobId& id, const std::string& request_id, const JobSpec& spec, const Now& now,
               const JobTerms& terms = {});
  /// The job that was made with a request id; null if there is none.
  const JobId* find_request(const std::string& request_id) const;
  /// ResourceExhausted if the user may have no further job now.
  absl::Status check_quota(const std::string& user) const;
  /// NotFound for an unknown job. A final job stays what it is.
  absl::Status cancel(const JobId& id, const Now& now);

  /// Forgets a final job; others are left alone.
  void forget(const JobId& id);

  /// Accepted results whose bytes the disk has not kept: their tasks are rendered again, and a job that was
  /// done runs again. (task, digest) that do not fit together any more are left alone.
  void lose_results(const JobId& id, const std::vector<std::pair<uint64_t, Digest>>& lost, const Now& now);

  /// Takes a worker's report. `shapes` are parallel to state.completed: what the result's bytes hold;
  /// NotFound if the blob is not here (the result is not acknowledged: the worker uploads it again), any
  /// other error if it is unusable (counts as a failure). Ignored for pilots.
  /// FailedPrecondition: a newer incarnation of this worker is at work.
  absl::Status report(const WorkerState& state, const std::vector<absl::StatusOr<ResultShape>>& shapes,
                      const Now& now);
  /// Grants leases and says what the worker should have. After report() with the same state; may be
  /// repeated later while the worker waits.
  SyncAnswer answer(const WorkerState& state, const Now& now);

  /// For so long nobody was listened to, which is no worker's silence.
  void excuse(double seconds);
  /// Ends the leases of silent workers, and those of tasks that have taken too long.
  void expire(const Now& now);
  /// When expire() will next have something to do, Now::steady; none without workers.
  std::optional<double> next_expiry() const;

  /// Changes since the last call, in order.
  std::vector<Change> take_changes();
  /// Since the last call.
  std::vector<Notice> take_notices() { return std::exchange(notices_, {}); }
  /// Grows whenever something happened that may interest a waiting worker or watcher.
  uint64_t revision() const { return revision_; }

  const std::map<JobId, std::unique_ptr<JobRecord>>& jobs() const { return jobs_; }
  const std::map<std::string, WorkerRecord>& workers() const { return workers_; }
  /// Every worker that has contributed a result, by incarnation.
  const std::map<std::string, WorkerInfo>& contributors() const { return contributors_; }
  const JobRecord* find(const JobId& id) const;
  /// The first of the jobs that must be done before this one and is not; null if there is none. A job that
  /// is no longer kept was done.
  const std::string* waits_for(const JobRecord& job) const;
  /// Leases of a user's jobs.
  uint64_t leased_by(const std::string& user) const;
  const UserQuota& quota_of(const std::string& user) const;

 private:
  using Identity = std::pair<std::string, std::string>;  // host, name

  JobRecord* find_job(const JobId& id);
  absl::StatusOr<WorkerRecord*> meet(const WorkerState& state, const Now& now);
  void complete(WorkerRecord& worker, const CompletedTask& task, const absl::StatusOr<ResultShape>& shape,
                const Now& now);
  void fail(WorkerRecord& worker, FailedTask failed, const Now& now);
  void take_load(const LoadedScene& scene);
  void blame_failure(JobRecord& job, uint64_t task, WorkerRecord& worker, const std::string& message,
                     const Now& now);
  void hold_back(WorkerRecord& worker, const JobId& job, const std::string& message, const Now& now);
  bool has_help(const WorkerRecord& worker) const;
  void expire_tasks(const Now& now);
  void end_lease(WorkerRecord& worker, JobRecord& job, uint64_t task);
  void end_worker(const std::string& id, const Now& now);
  void advance(JobRecord& job, const Now& now);
  void finish(JobRecord& job, JobState state, FailureKind failure, std::string message, const Now& now);
  void grant(WorkerRecord& worker, uint32_t wanted, const Now& now);
  void put_lease(WorkerRecord& worker, JobRecord& job, const LeaseId& lease, const Now& now);
  JobRecord* next_job(const std::set<const JobRecord*>& passed_over) const;
  void fail_followers(const JobRecord& job, const Now& now);
  uint64_t pending() const;
  int cores() const;
  void put(Change change);
  void note(JobRecord& job, std::optional<uint64_t> task, const std::string& worker, const std::string& text,
            const Now& now);
  About about(const JobRecord& job, std::optional<uint64_t> task, const std::string& worker) const;
  void keep_log(const LeaseId& lease, const WorkerRecord& worker, const std::string& text, const Now& now);
  FaultCounts& count_fault(JobRecord& job);

  SchedulerLimits limits_;
  std::map<JobId, std::unique_ptr<JobRecord>> jobs_;
  std::vector<JobRecord*> order_;  ///< of submission; final jobs leave it
  std::map<std::string, JobId> requests_;
  std::map<std::string, WorkerRecord> workers_;
  std::map<Identity, std::string> incarnations_;
  std::map<std::string, double> retired_;  ///< incarnation -> when it was replaced
  std::map<std::string, WorkerInfo> contributors_;
  std::vector<Change> changes_;
  std::set<JobId> touched_;  ///< headers to be stored with the next changes
  std::vector<Notice> notices_;
  uint64_t revision_ = 0;
};

}  // namespace penumbra
