#pragma once
// The one thread that owns the scheduler and writes the job store. Everybody else posts work to it. Work
// that arrives while the store is busy is committed together (group commit), and no reply leaves before
// what it says is durable.
#include <atomic>
#include <condition_variable>
#include <functional>
#include <future>
#include <list>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "absl/status/statusor.h"
#include "proto/blob_folder.h"
#include "server/job_store.h"
#include "server/scheduler.h"

namespace penumbra {

class Coordinator {
 public:
  using Clock = std::function<Now()>;
  /// Called once, on the coordinator's thread, when the answer is durable.
  using SyncReply = std::function<void(absl::StatusOr<DesiredState>)>;

  Coordinator(std::unique_ptr<JobStore> store, BlobFolder blobs, SchedulerLimits limits, Clock clock);
  ~Coordinator();

  /// Loads the store and starts the thread.
  absl::Status start();
  /// Answers what waits, commits, ends the thread.
  void stop();
  /// The store has failed: nothing can be acknowledged any more. The process should end; a restart
  /// continues from what is durable.
  bool failed() const { return failed_; }

  /// Runs work(scheduler, now) on the coordinator's thread and returns its result once everything that it
  /// changed is durable. Unavailable after stop() or a failed store.
  template <class Work>
  auto call(Work work) -> absl::StatusOr<std::invoke_result_t<Work, Scheduler&, const Now&>> {
    using Result = std::invoke_result_t<Work, Scheduler&, const Now&>;
    auto promise = std::make_shared<std::promise<absl::StatusOr<Result>>>();
    auto future = promise->get_future();
    post(
        [work = std::move(work), promise](Scheduler& scheduler, const Now& now) -> Finish {
          auto result = std::make_shared<Result>(work(scheduler, now));
          return [result, promise](const absl::Status& durable) {
            if (durable.ok())
              promise->set_value(std::move(*result));
            else
              promise->set_value(durable);
          };
        },
        [promise] { promise->set_value(absl::UnavailableError("the server is stopping")); });
    return future.get();
  }

  /// Names one sync() for cancel_sync().
  uint64_t new_ticket() { return next_ticket_++; }
  /// A worker's Sync: reports, and answers at once or when there is something to say.
  void sync(uint64_t ticket, WorkerState state, std::vector<absl::StatusOr<ResultShape>> shapes,
            SyncReply reply);
  /// The worker no longer waits: the reply comes at once, for whatever it is worth.
  void cancel_sync(uint64_t ticket);

  /// Returns when anything has happened since `revision`, or after the timeout; gives the new revision.
  uint64_t wait_for_change(uint64_t revision, double seconds);

  /// What workers logged of a job's tasks, or of one tile's: the latest attempts of no more than `most_bytes`
  /// together, oldest first. NotFound: no such job. InvalidArgument: no such tile.
  absl::StatusOr<std::vector<PutLog>> worker_logs(const JobId& job, std::optional<uint64_t> tile,
                                                  size_t most_bytes);

  const BlobFolder& blobs() const { return blobs_; }

 private:
  using Finish = std::function<void(const absl::Status& durable)>;
  using Work = std::function<Finish(Scheduler&, const Now&)>;
  struct Posted {
    Work work;
    std::function<void()> refuse;
  };
  /// A Sync that waits for something to say.
  struct Waiting {
    uint64_t ticket;
    WorkerState state;
    double deadline;
    SyncReply reply;
    bool fresh = true;  ///< not looked at yet
  };

  void post(Work work, std::function<void()> refuse);
  void run();
  std::vector<Posted> next_batch();
  double next_deadline() const;
  void answer_waiting(const Now& now, std::vector<Finish>& finished, bool all);
  absl::Status commit();
  absl::Status rest();
  absl::Status give_up(const absl::Status& why);

  std::unique_ptr<JobStore> store_;
  BlobFolder blobs_;
  Clock clock_;
  // Only the coordinator's thread touches these.
  Scheduler scheduler_;
  std::list<Waiting> waiting_;
  uint64_t answered_revision_ = 0;
  double next_rest_ = 0;  ///< Now::steady

  std::mutex mutex_;
  std::condition_variable posted_, changed_;
  std::vector<Posted> inbox_;        // guarded by mutex_
  bool stopping_ = false;            // guarded by mutex_
  uint64_t published_revision_ = 0;  // guarded by mutex_
  std::atomic<uint64_t> next_ticket_{1};
  std::atomic<bool> failed_{false};
  std::thread thread_;
};

}  // namespace penumbra
