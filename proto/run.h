#pragma once
// What a job says about itself: where it stands, and what came of it. The same as the messages of
// proto/render.proto; the comments there give the full meaning of each figure.
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "proto/job.h"
#include "proto/job_terms.h"

namespace penumbra {

/// Short, printable, without blanks.
using JobId = std::string;

enum class JobState { kQueued, kPilot, kRunning, kDone, kFailed, kCancelled };

/// True for the states that do not change any more, but for one way back: a job that is done runs again if
/// the disk has not kept one of its results.
inline bool is_final(JobState state) {
  return state >= JobState::kDone;
}
/// One lower-case word: "queued", "pilot", …
std::string_view name_of(JobState state);

/// Whose fault a failure is: decides the exit code (2 or 1).
enum class FailureKind { kNone, kBadInput, kJobFailed };

/// What went wrong on a job's way and was made good; the comments of proto/render.proto say what each counts.
struct FaultCounts {
  uint64_t lost_leases = 0, overdue_leases = 0, late_results = 0, refused_results = 0;
  uint64_t failures = 0, returned_leases = 0, corrupt_results = 0;
  bool operator==(const FaultCounts&) const = default;
};

struct JobStatus {
  JobId job;
  JobState state = JobState::kQueued;
  FailureKind failure = FailureKind::kNone;
  std::string message;  ///< one line for people
  double fraction = 0;  ///< of the pilot's tasks, then of the run's pixel-passes; 0 to 1
  uint64_t tasks_done = 0, tasks_total = 0, tasks_leased = 0;
  double cpu_seconds = 0;  ///< accepted run tasks, all mixes
  double pilot_cpu_seconds = 0;
  std::vector<int64_t> plan;   ///< passes per mix; empty until planned
  double wall_seconds = 0;     ///< since the first run task was leased
  int workers = 0, cores = 0;  ///< connected
  uint64_t retries = 0;        ///< leases that were given out again
  std::string scene;
  double submitted_unix_seconds = 0;
  FaultCounts faults;
  JobTerms terms;
  bool operator==(const JobStatus&) const = default;
};

/// One line of a job's log: what became of a lease, or of the job.
struct LogLine {
  double unix_seconds = 0;
  std::optional<uint64_t> task;  ///< none: of the job itself
  std::string worker;            ///< host/name; empty where no worker is concerned
  std::string text;
  bool operator==(const LogLine&) const = default;
};

/// All tiles have finished the same pass of a mix.
struct Checkpoint {
  int64_t passes = 0;
  double cpu_seconds = 0;  ///< of this mix, cumulative
  bool operator==(const Checkpoint&) const = default;
};

struct MixSummary {
  Mix mix;
  int64_t planned_passes = 0;
  int64_t passes = 0;  ///< done in every pixel
  double cpu_seconds = 0;
  uint64_t rays = 0, line_queries = 0, non_finite = 0;
  double pilot_cpu_seconds = 0;
  std::vector<std::string> substitutions;
  std::vector<Checkpoint> checkpoints;  ///< reached by every tile, ascending
  Calibration calibration;              ///< timed beside this mix's slices
  bool operator==(const MixSummary&) const = default;
};

struct TileRow {
  PixelRect rect;
  int mix = 0;
  int64_t passes = 0;
  double cpu_seconds = 0;
  std::string worker;
  Calibration calibration;
  bool operator==(const TileRow&) const = default;
};

/// Everything about a run that is not a pixel.
struct RunSummary {
  JobStatus status;
  JobSpec spec;
  std::vector<MixSummary> mixes;
  std::vector<TileRow> tiles;
  std::vector<WorkerInfo> workers;
  LoadReport load;
  double worker_cpu_seconds = 0;
  double render_wall_seconds = 0;
  double total_wall_seconds = 0;
  double first_result_seconds = 0;
  std::vector<AutoPlan> auto_plans;  ///< one for each automatic mix, once planned
  std::vector<EarlierPlan> earlier_plans;  ///< of a run in stages: what was planned before
  bool operator==(const RunSummary&) const = default;
};

}  // namespace penumbra
