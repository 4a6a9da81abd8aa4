#pragma once
// One job as the scheduler sees it: its tasks, who holds them, what was accepted.
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "server/changes.h"
#include "server/planner.h"

namespace penumbra {

/// Moments on the three clocks that the server's state refers to; always passed in.
struct Now {
  double steady = 0;       ///< seconds, monotonic: deadlines
  double unix_time = 0;    ///< seconds since 1970: for people
  double process_cpu = 0;  ///< CPU seconds of the server process
};

enum class TaskState : uint8_t { kPending, kLeased, kDone };

struct TaskRecord {
  TaskState state = TaskState::kPending;
  bool begun = false;  ///< the holder has begun to render
  double since = 0;    ///< Now::steady of the lease, then of the beginning: what a limit counts from
  uint64_t epoch = 0;  ///< of the latest lease; 0: never leased
  std::string holder;  ///< worker incarnation; empty unless leased
};

struct AcceptedResult {
  Digest result;
  std::vector<MixCost> costs;
  std::string worker;
};

/// Who has failed at a task. Reported failures and deaths are counted apart: a death may have had any
/// cause, and farms kill workers for reasons of their own.
struct Blame {
  std::set<std::string> reporters;  ///< identities of workers: a restart makes no new one
  int reports = 0;
  std::set<std::string> deaths;
};

/// Tasks are numbered from 0: first the pilot's (if there is one), then, once planned, the run's. Of a run in
/// stages (server/stages.h) only what is sure is given out.
class JobRecord {
 public:
  explicit JobRecord(JobHeader header);

  JobHeader header;
  double scheduler_cpu_base = 0;  ///< Now::process_cpu when accounting (re)started
  std::map<uint64_t, Blame> blames;
  std::deque<LogLine> log;  ///< the latest kMostLogLines; not stored
  static constexpr size_t kMostLogLines = 1000;
  void append_log(LogLine line) {
    if (log.size() >= kMostLogLines) log.pop_front();
    log.push_back(std::move(line));
  }

  /// The tile that a task renders, as a place in tiles().
  uint64_t tile_of(uint64_t task) const {
    return (is_pilot(task) ? task : task - first_run_id_) % tiles_.size();
  }

  const JobSpec& spec() const { return header.spec; }
  bool final() const { return is_final(header.state); }
  const std::vector<PixelRect>& tiles() const { return tiles_; }
  /// InvalidArgument: a user has named a tile that is not one.
  absl::Status check_tile(uint64_t tile) const;
  const std::optional<Plan>& plan() const { return plan_; }
  uint64_t first_run_id() const { return first_run_id_; }

  uint64_t pending() const { return final() ? 0 : queue_.size(); }
  uint64_t leased() const { return leased_; }
  uint64_t retries() const { return retries_; }
  uint64_t stage_done() const { return stage_done_; }
  uint64_t stage_total() const { return stage_total_; }
  /// Of the run, by pixel-passes; of the pilot, by tasks.
  double fraction() const;

  /// Null for an id that the job does not have (yet).
  const TaskRecord* task(uint64_t id) const { return id < tasks_.size() ? &tasks_[id] : nullptr; }
  TileTask description(uint64_t id) const;
  bool is_pilot(uint64_t id) const { return id < first_run_id_; }
  /// One per task; empty where nothing was accepted.
  const std::vector<std::optional<AcceptedResult>>& results() const { return results_; }

  /// Leases the pending task with the lowest id, leaving out those whose blame `refuses`. None if there is
  /// none.
  std::optional<LeaseId> lease(const std::string& holder, const Now& now,
                               const std::function<bool(const Blame&)>& refuses);
  void mark_begun(uint64_t id, const Now& now);
  /// Back to the queue; the epoch stays.
  void release(uint64_t id);
  /// Requires a task that is leased.
  void accept(uint64_t id, AcceptedResult result);
  /// The bytes of an accepted run task are gone: back to the queue. The epoch stays.
  void lose(uint64_t id);
  /// Every task of the pilot is done and there is no plan yet (at once, for a job without pilot).
  bool ready_to_plan() const { return !plan_ && stage_done_ == stage_total_; }
  /// Makes the plan and the run's tasks. Error: what planned_passes says.
  absl::Status make_run();
  /// Everything that the next open border's decision is made on is done.
  bool ready_to_replan() const;
  /// Decides it: totals anew, and tasks as they follow from them. Error: what replanned() says.
  absl::Status replan();
  bool all_done() const { return plan_ && stage_done_ == stage_total_; }

  /// As stored: brings back plan, epochs, leases and results. Internal for a store that contradicts itself.
  absl::Status restore(const StoredJob& stored, const Now& now);

 private:
  void add_tasks(uint64_t count);
  std::vector<std::vector<MixCost>> pilot_costs() const;
  PlannedPasses planned() const;
  absl::Status set_plan(PlannedPasses planned);
  bool measured(uint64_t id) const;
  double work(uint64_t id) const;

  std::vector<PixelRect> tiles_;
  std::optional<Plan> plan_;
  uint64_t first_run_id_ = 0;
  std::vector<TaskRecord> tasks_;
  std::vector<std::optional<AcceptedResult>> results_;
  std::set<uint64_t> queue_;
  uint64_t leased_ = 0, retries_ = 0;
  uint64_t stage_done_ = 0, stage_total_ = 0;
  uint64_t unmeasured_ = 0;                ///< run tasks that the next open border's decision still waits for
  double work_done_ = 0, work_total_ = 0;  ///< pixel-passes of the run
};

}  // namespace penumbra
