#pragma once
// What this worker has to do and has done: the state that Sync tells, and what the answers change in it.
// Threads meet here and nowhere else. Knows no network.
#include <atomic>
#include <condition_variable>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "proto/sync.h"

namespace penumbra {

/// A leased task in the hands of this worker.
struct Assignment {
  LeaseId lease;
  TileTask task;
  std::shared_ptr<const JobSpec> job;
  std::atomic<bool> cancel{false};  ///< the lease is lost: stop rendering
};

/// A finished task with the bytes of its result, kept until the server acknowledges it.
struct Finished {
  CompletedTask report;
  std::string bytes;  ///< of report.result; empty for a pilot
  // Guarded by the board, once it has this.
  bool along = false;      ///< the bytes travel with the report: they have not been uploaded
  bool uploading = false;  ///< the server lacks them: they are on their way
};

class TaskBoard {
 public:
  /// One to render and one to go on with.
  static constexpr uint32_t kLeasesPerThread = 2;

  explicit TaskBoard(int threads) : wanted_(kLeasesPerThread * static_cast<uint32_t>(threads)) {}

  // For the Sync loop.

  /// Fills in what the board knows: reports, leases, jobs, wanted, draining. Of results that travel along no
  /// more than fit into one Sync; the rest are still called held, and are news.
  void describe(WorkerState& state);
  /// Takes the answer to `told`. Returns the results that the server wants uploaded, each once: it has lost
  /// their blobs, or had no room for what came along. They are called held until uploaded() is told of them.
  std::vector<std::shared_ptr<Finished>> apply(const DesiredState& desired, const WorkerState& told);
  void uploaded(Finished& finished);
  /// Whether a finished task still waits to be acknowledged.
  bool wants(const LeaseId& lease) const;
  /// It holds all the leases that it wants; never while it drains.
  bool full() const;
  /// What ended a wait.
  enum class Woken { kTime, kNews, kDone };
  /// True if there is something to report that describe() has not seen yet. Blocks up to `seconds`.
  bool wait_for_news(double seconds);
  /// As wait_for_news(), returning early when `done` is set by set().
  Woken wait_for_news_or(const bool& done, double seconds);
  /// Until `done` is set by set(), for up to `seconds`; whether it is.
  bool wait_for(const bool& done, double seconds);
  /// Whoever waits for `done` sees it under the board's lock, so that board and flag outlive the call that
  /// sets it.
  void set(bool& done);

  // For the render threads.

  /// The next task; blocks. Null when the board is closed.
  std::shared_ptr<Assignment> take();
  /// Rendered and, for a run task, uploaded, unless its bytes are to travel along.
  void complete(const Assignment& assignment, std::shared_ptr<Finished> finished);
  void fail(const Assignment& assignment, TaskFailure reason, std::string message, std::string log);
  /// The task was cancelled: nothing to report.
  void drop(const Assignment& assignment);
  /// Once per job; later calls do nothing.
  void loaded(const LoadedScene& scene);

  // For the end.

  /// No new leases; tasks that have not begun are handed back.
  void drain();
  /// Cancels what is being rendered and hands it back.
  void abandon();
  /// Nothing held, nothing to report.
  bool empty() const;
  /// take() returns null from now on; what is held is cancelled.
  void close();

 private:
  struct Held {
    std::shared_ptr<Assignment> assignment;
    bool begun = false;
    bool lost = false;  ///< cancelled by the server; its thread has not noticed yet
  };
  uint32_t lost_threads() const;
  void hand_back(const LeaseId& lease, std::string message);

  mutable std::mutex mutex_;
  std::condition_variable work_, news_cv_;
  uint32_t wanted_;  ///< leases to hold while not draining
  bool draining_ = false, closed_ = false, news_ = true;
  std::map<LeaseId, Held> held_;
  std::map<LeaseId, std::shared_ptr<Finished>> completed_;
  std::map<LeaseId, FailedTask> failed_;
  std::map<JobId, std::shared_ptr<const JobSpec>> jobs_;
  std::map<JobId, LoadedScene> loads_;  ///< not acknowledged
  std::set<JobId> reported_loads_;
};

}  // namespace penumbra
