#pragma once
// Blobs between this worker and the server.
#include <grpcpp/channel.h>

#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <string_view>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "proto/blob_folder.h"
#include "proto/blobs.grpc.pb.h"

namespace penumbra {

/// Safe for several threads. Calls fail with Unavailable while the server cannot be reached; the caller
/// decides how long to try again.
class BlobClient {
 public:
  explicit BlobClient(const std::shared_ptr<grpc::Channel>& channel) : stub_(v1::Blobs::NewStub(channel)) {}

  /// Sends a tile result. The Sync that reports it makes it durable.
  absl::Status upload(const Digest& digest, std::string_view bytes) const;
  /// Fetches a blob into the folder unless it is there and whole, going on where an earlier attempt stopped.
  /// Another process that fetches the same blob into the same folder is waited for. NotFound or DataLoss: the
  /// server's copy is gone or corrupt.
  absl::Status fetch(const Digest& digest, uint64_t size, const BlobFolder& folder) const;
  /// Fetches a small blob of unknown size and reads it.
  absl::StatusOr<std::string> fetch_small(const Digest& digest, const BlobFolder& folder) const;

 private:
  bool whole(const Digest& digest, const BlobFolder& folder) const;
  mutable std::mutex mutex_;
  mutable std::set<Digest> verified_;  ///< found whole by this process; guarded by mutex_
  absl::Status download(const Digest& digest, uint64_t size, const BlobFolder& folder) const;
  std::unique_ptr<v1::Blobs::Stub> stub_;
};

}  // namespace penumbra
