#pragma once
// What the store lets go: finished jobs by age and by size, and blobs that no job names any more.
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <thread>

#include "absl/status/statusor.h"
#include "server/coordinator.h"

namespace penumbra {

struct RetentionLimits {
  double keep_seconds = 30 * 86400.0;     ///< finished jobs older than this go
  uint64_t keep_bytes = UINT64_MAX;       ///< of results; above it the oldest finished jobs go
  double keep_uploads_seconds = 86400.0;  ///< blobs that no job names, since they were last asked for
};

struct Swept {
  uint64_t jobs = 0, blobs = 0, bytes = 0;  ///< removed
  uint64_t left_bytes = 0;
};

/// One round. Jobs first (their rows are gone, durably, before their blobs go), then blobs.
absl::StatusOr<Swept> sweep(Coordinator& coordinator, const RetentionLimits& limits);

/// Sweeps every now and then until it is destroyed.
class Retention {
 public:
  Retention(Coordinator& coordinator, const RetentionLimits& limits);
  ~Retention();

 private:
  void run();
  Coordinator& coordinator_;
  RetentionLimits limits_;
  std::mutex mutex_;
  std::condition_variable wake_;
  bool stopping_ = false;  // guarded by mutex_
  std::thread thread_;
};

}  // namespace penumbra
