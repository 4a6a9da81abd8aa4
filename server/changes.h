#pragma once
// What a job store keeps, and the changes to it that the scheduler asks for. The scheduler itself knows
// no disk: it hands out changes, and nothing is acknowledged to anyone before they are durable.
#include <string>
#include <variant>
#include <vector>

#include "proto/job.h"
#include "proto/run.h"
#include "proto/sync.h"

namespace penumbra {

/// Everything about a job except its tasks.
struct JobHeader {
  JobId id;
  std::string request_id;  ///< unique: makes Submit idempotent
  JobSpec spec;
  JobState state = JobState::kQueued;
  FailureKind failure = FailureKind::kNone;
  std::string message;
  std::vector<int64_t> passes;             ///< planned, per mix; empty until then
  std::vector<AutoPlan> auto_plans;        ///< planned with `passes`, one for each automatic mix
  std::vector<EarlierPlan> earlier_plans;  ///< what was planned in the stages before
  std::vector<double> open_borders;        ///< where the plan will be looked at again (server/stages.h)
  bool loaded = false;                     ///< `load` and `substitutions` are known
  LoadReport load;
  std::vector<Substitution> substitutions;
  // Seconds since 1970; 0 until it has happened.
  double submitted_unix = 0, first_lease_unix = 0, first_result_unix = 0, last_result_unix = 0;
  double finished_unix = 0;
  double worker_cpu_seconds = 0;
  double scheduler_cpu_seconds = 0;
  FaultCounts faults;
  JobTerms terms;
  bool operator==(const JobHeader&) const = default;
};

/// The incarnation that holds a lease, with what is needed to recognise its successor.
struct LeaseHolder {
  std::string worker;      ///< WorkerInfo.id
  std::string host, name;  ///< identity that survives restarts
  bool operator==(const LeaseHolder&) const = default;
};

// The closed set of changes. A new one needs: its struct here, its name in Change, its statement in
// sqlite_store.cpp.

/// Writes a job's header, new or not.
struct PutJob {
  JobHeader job;
};
/// A lease was granted: the task's epoch and holder.
struct PutLease {
  LeaseId lease;
  LeaseHolder holder;
};
/// A lease ended without a result. The epoch stays, or a late result could not be told from a new one.
struct DropLease {
  LeaseId lease;
};
/// A result was accepted; ends the lease.
struct PutResult {
  LeaseId lease;
  Digest result;  ///< empty for a pilot
  std::vector<MixCost> costs;
  std::string worker;
};
/// The bytes of an accepted result are gone: the task is pending again. The epoch stays.
struct DropResult {
  LeaseId lease;
};
/// A worker has failed at a task, or died of it: counted over restarts, or a task that takes the server with
/// it would be tried for ever.
struct PutBlame {
  JobId job;
  uint64_t task = 0;
  std::string who;  ///< identity of a reporter, or incarnation that died
  bool death = false;
};
/// What a worker logged of an attempt at a task. Never read by the scheduler.
struct PutLog {
  LeaseId lease;
  std::string worker;  ///< host/name
  double unix_time = 0;
  std::string text;
};
/// A final job is forgotten with everything that belongs to it.
struct DropJob {
  JobId job;
};
/// A worker has contributed a result.
struct PutWorker {
  WorkerInfo worker;
};

using Change =
    std::variant<PutJob, PutLease, DropLease, PutResult, DropResult, PutBlame, PutLog, DropJob, PutWorker>;

/// A job as it comes back from a store.
struct StoredJob {
  JobHeader header;
  struct Lease {
    LeaseId lease;
    LeaseHolder holder;  ///< worker is empty if the lease has ended
  };
  std::vector<Lease> leases;
  std::vector<PutResult> results;
  struct BlameCount {
    PutBlame blame;
    uint64_t count = 1;
  };
  std::vector<BlameCount> blames;
};

struct StoredState {
  std::vector<StoredJob> jobs;  ///< in order of submission
  std::vector<WorkerInfo> workers;
  /// Jobs that this version does not understand, and why: they stay in the store and are not served.
  std::vector<std::pair<JobId, std::string>> unreadable = {};
};

}  // namespace penumbra
