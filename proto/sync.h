#pragma once
// The two halves of a Sync: what a worker has, and what it should have (proto/worker.proto).
#include <cstdint>
#include <string>
#include <vector>

#include "proto/job.h"
#include "proto/run.h"

namespace penumbra {

inline constexpr uint32_t kSyncProtocol = 5;

/// A result up to this size may travel in the Sync that reports it: a call less for each tile. A tile of 64 ×
/// 64 pixels with two mixes has 229 kB.
inline constexpr size_t kMostBytesAlong = size_t{256} << 10;

/// Names one lease for ever: the epoch grows each time the task is leased again.
struct LeaseId {
  JobId job;
  uint64_t task = 0;
  uint64_t epoch = 0;
  auto operator<=>(const LeaseId&) const = default;
  bool operator==(const LeaseId&) const = default;
};

struct HeldLease {
  LeaseId lease;
  bool begun = false;  ///< rendering has begun
  bool operator==(const HeldLease&) const = default;
};

struct CompletedTask {
  LeaseId lease;
  Digest result;  ///< blob of the serialised TileResult; empty for a pilot
  /// The blob's bytes, at most kMostBytesAlong, if they come with the report instead of by an upload of their
  /// own.
  std::string bytes;
  std::vector<MixCost> costs;
  std::string log;  ///< what was logged while it was rendered, the tail
  bool operator==(const CompletedTask&) const = default;
};

enum class TaskFailure { kBadInput, kError, kReturned, kLostInput };

struct FailedTask {
  LeaseId lease;
  TaskFailure reason = TaskFailure::kError;
  std::string message;
  std::string log;  ///< as CompletedTask::log
  bool operator==(const FailedTask&) const = default;
};

struct Substitution {
  int mix = 0;
  std::string text;
  bool operator==(const Substitution&) const = default;
};

struct LoadedScene {
  JobId job;
  LoadReport report;
  std::vector<Substitution> substitutions;
  bool operator==(const LoadedScene&) const = default;
};

/// A worker's whole state.
struct WorkerState {
  std::string version;  ///< of the program
  WorkerInfo worker;
  std::string name;  ///< which of the host's workers; stays the same over restarts
  std::vector<HeldLease> held;
  std::vector<CompletedTask> completed;
  std::vector<FailedTask> failed;
  std::vector<LoadedScene> loaded;
  uint32_t wanted = 0;  ///< leases in all, counting held
  std::vector<JobId> known_jobs;
  double process_cpu_seconds = 0;
  uint32_t wait_milliseconds = 0;
  bool draining = false;
  bool operator==(const WorkerState&) const = default;
};

struct DesiredLease {
  LeaseId lease;
  std::optional<TileTask> task;  ///< only where the worker did not list it as held
  bool operator==(const DesiredLease&) const = default;
};

struct JobDescription {
  JobId job;
  JobSpec spec;
  bool operator==(const JobDescription&) const = default;
};

/// What the worker should have.
struct DesiredState {
  std::vector<DesiredLease> leases;
  std::vector<JobDescription> jobs;
  std::vector<LeaseId> acknowledged;
  std::vector<JobId> acknowledged_loads;
  std::vector<JobId> finished_jobs;
  uint32_t next_sync_milliseconds = 500;
  bool operator==(const DesiredState&) const = default;
};

}  // namespace penumbra
