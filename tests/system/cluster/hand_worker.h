#pragma once
// A worker played by hand: says to the server what no honest worker would.
#include <string>
#include <vector>

#include "film/tile_pixels.h"
#include "proto/sync.h"
#include "tests/system/cluster/cluster.h"

namespace penumbra {

class HandWorker {
 public:
  HandWorker(Cluster& cluster, const std::string& name);

  WorkerState state;  ///< what the next call tells
  /// One Sync with `told`; on success the answer.
  absl::StatusOr<DesiredState> say(const WorkerState& told);
  /// Takes up to `wanted` leases; their descriptions.
  std::vector<DesiredLease> take(uint32_t wanted);
  /// A report of a lease with these bytes as its result, which are uploaded.
  CompletedTask result_of(const DesiredLease& lease, const std::string& bytes);

 private:
  Cluster& cluster_;
};

/// Bytes of a result of the right shape, every value being `value`.
std::string flat_result(const TileTask& task, float value);

}  // namespace penumbra
