#pragma once
// What the pages and metrics show of the scheduler: copied now and then, so that any number of viewers costs
// the coordinator one copy a second.
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "server/coordinator.h"
#include "server/job_report.h"

namespace penumbra {

struct WorkerView {
  WorkerInfo info;
  std::string name, version;
  size_t leases = 0;
  bool draining = false;
  double silence_seconds = 0;  ///< since its last call
  double cpu_seconds = 0;      ///< of its process
  std::string set_aside;       ///< why it gets no more tasks; empty: it does
};

struct JobView {
  JobStatus status;
  std::vector<std::string> mixes;  ///< labels
};

struct Snapshot {
  std::vector<JobView> jobs;  ///< newest first
  std::vector<WorkerView> workers;
  double taken_unix = 0;          ///< seconds since 1970
  double server_cpu_seconds = 0;  ///< of this process
};

/// A job's figures and why it is (not) running, taken at one moment.
struct JobDetail {
  JobStatus status;
  std::vector<MixSummary> mixes;
  std::vector<std::string> why;
};

class Snapshots {
 public:
  explicit Snapshots(Coordinator& coordinator) : coordinator_(coordinator) {}
  /// Not older than a second. Unavailable when the coordinator has stopped or its store has failed.
  absl::StatusOr<std::shared_ptr<const Snapshot>> latest();
  /// Not older than a second. NotFound for a job that the latest snapshot does not have.
  absl::StatusOr<std::shared_ptr<const JobDetail>> detail(const JobId& job);

 private:
  struct Kept {
    std::shared_ptr<const JobDetail> detail;
    double taken = 0;  ///< steady seconds
  };
  absl::StatusOr<std::shared_ptr<const Snapshot>> current();  // with mutex_ held
  absl::StatusOr<std::shared_ptr<const Snapshot>> take();     // likewise

  Coordinator& coordinator_;
  std::mutex mutex_;
  std::shared_ptr<const Snapshot> latest_;  // guarded by mutex_
  double latest_steady_ = 0;                // guarded by mutex_
  std::map<JobId, JobView> final_;          // guarded by mutex_: what never changes again is copied once
  std::map<JobId, Kept> details_;           // guarded by mutex_
};

}  // namespace penumbra
