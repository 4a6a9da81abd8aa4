#pragma once
// One blob's way in and out, message by message, whatever carries the messages.
#include <functional>

#include "absl/status/statusor.h"
#include "proto/blob_folder.h"
#include "proto/blobs.pb.h"

namespace penumbra {

struct BlobLimits {
  uint64_t most_bytes = uint64_t{1} << 36;  ///< of one blob
  /// Bytes of the disk that blobs leave free, so that the job store can always write: a full disk stops
  /// uploads (RESOURCE_EXHAUSTED; workers keep their results and try again), not the server.
  uint64_t reserve_bytes = uint64_t{256} << 20;
};

/// Whether a blob of that size may be stored. InvalidArgument: never; ResourceExhausted: not now.
absl::Status check_room(const BlobFolder& blobs, const BlobLimits& limits, const Digest& digest,
                        uint64_t bytes);

/// Which of the digests are not here. InvalidArgument for one that is none, and for too many.
absl::StatusOr<v1::FindMissingResponse> missing_blobs(const BlobFolder& blobs,
                                                      const v1::FindMissingRequest& request);

/// Takes a blob from the messages that `read` gives (false: there are no more). Bytes of the whole blob, or
/// what proto/blobs.proto says of Upload.
absl::StatusOr<uint64_t> receive_blob(const BlobFolder& blobs, const BlobLimits& limits,
                                      const std::function<bool(v1::UploadChunk&)>& read);

/// Gives a blob to `write` (false: nobody listens any more). Errors are what proto/blobs.proto says of
/// Download.
absl::Status send_blob(const BlobFolder& blobs, const v1::DownloadRequest& request,
                       const std::function<bool(const v1::DownloadChunk&)>& write);

}  // namespace penumbra
