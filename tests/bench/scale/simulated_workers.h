#pragma once
// Workers that render nothing: they lease, wait, upload results of the size of real ones, and report.
#include <atomic>
#include <condition_variable>
#include <deque>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "proto/blobs.grpc.pb.h"
#include "proto/sync.h"
#include "proto/worker.grpc.pb.h"

namespace penumbra {

struct SimulationOptions {
  std::string address;
  int workers = 100;
  int channels = 8;         ///< connections that they share
  int uploaders = 2;        ///< threads that upload
  double task_seconds = 0;  ///< that a task takes
};

/// Counts since the start.
struct SimulationCounts {
  std::atomic<uint64_t> leases{0}, accepted{0}, syncs{0}, failed_syncs{0}, result_bytes{0};
};

class SimulatedWorkers {
 public:
  explicit SimulatedWorkers(const SimulationOptions& options);
  ~SimulatedWorkers();
  const SimulationCounts& counts() const { return counts_; }

 private:
  struct Worker;
  void sync(Worker& worker);
  void answered(Worker& worker, const grpc::Status& status);
  void upload_loop();
  void finish(Worker& worker, const DesiredLease& lease);
  void upload(v1::Blobs::Stub& blobs, const Digest& digest, const std::string& bytes);
  std::string result_of(const TileTask& task);

  SimulationOptions options_;
  SimulationCounts counts_;
  std::vector<std::unique_ptr<v1::Worker::Stub>> stubs_;
  std::vector<std::unique_ptr<v1::Blobs::Stub>> blobs_;
  std::vector<std::unique_ptr<Worker>> workers_;

  struct Due {
    double at;
    Worker* worker;
  };
  std::mutex mutex_;
  std::condition_variable ready_;
  std::deque<Due> due_;  // in order of time: every task takes equally long; guarded by mutex_
  std::atomic<bool> stopping_{false};
  std::atomic<int> calls_{0};
  std::atomic<uint64_t> serial_{0};
  std::vector<std::thread> uploaders_;
};

}  // namespace penumbra
