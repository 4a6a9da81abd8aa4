#pragma once
// Where jobs, leases and accepted results survive. Pixels never come here: they are blobs.
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "server/changes.h"

namespace penumbra {

class JobStore {
 public:
  virtual ~JobStore() = default;
  /// All changes or none, in order; durable when it returns. Called by one thread.
  virtual absl::Status apply(const std::vector<Change>& changes) = 0;
  virtual absl::StatusOr<StoredState> load() = 0;
  /// What workers logged of the tasks with id % modulus == remainder: the latest attempts whose texts have
  /// no more than `most_bytes` together, oldest first.
  virtual absl::StatusOr<std::vector<PutLog>> logs(const JobId& job, uint64_t modulus, uint64_t remainder,
                                                   size_t most_bytes) = 0;
  /// Work that would hold up an apply(): called by the same thread about once a second, when all replies are
  /// out. Aborted: the store belongs to another server now.
  virtual absl::Status rest() { return absl::OkStatus(); }
};

}  // namespace penumbra
