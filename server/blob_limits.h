#pragma once
// What the server stores for others, and what it keeps free.
#include "absl/status/status.h"
#include "proto/blob_folder.h"
#include "proto/status.h"

namespace penumbra {

struct BlobLimits {
  uint64_t most_bytes = uint64_t{1} << 36;  ///< of one blob
  /// Bytes of the disk that blobs leave free, so that the job store can always write: a full disk stops
  /// uploads (RESOURCE_EXHAUSTED; workers keep their results and try again), not the server.
  uint64_t reserve_bytes = uint64_t{256} << 20;
};

/// Whether a blob of that size may be stored. InvalidArgument: too large ever; ResourceExhausted: now.
inline absl::Status check_room(const BlobFolder& blobs, const BlobLimits& limits, const Digest& digest,
                               uint64_t bytes) {
  if (bytes > limits.most_bytes)
    return make_status(absl::StatusCode::kInvalidArgument, "blob {}: {} bytes, the limit is {}", digest,
                       bytes, limits.most_bytes);
  if (const uint64_t free = blobs.free_bytes(); free < limits.reserve_bytes + bytes)
    return make_status(absl::StatusCode::kResourceExhausted,
                       "blob {}: {} bytes; the server's disk has {} left and keeps {} of them free", digest,
                       bytes, free, limits.reserve_bytes);
  return absl::OkStatus();
}

}  // namespace penumbra
