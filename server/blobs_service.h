#pragma once
#include "proto/blob_folder.h"
#include "proto/blobs.grpc.pb.h"

namespace penumbra {

struct BlobLimits {
  uint64_t most_bytes = uint64_t{1} << 36;  ///< of one blob
  /// Bytes of the disk that blobs leave free, so that the job store can always write: a full disk stops
  /// uploads (RESOURCE_EXHAUSTED; workers keep their results and try again), not the server.
  uint64_t reserve_bytes = uint64_t{256} << 20;
};

/// proto/blobs.proto over a folder. Translates only.
class BlobsService final : public v1::Blobs::Service {
 public:
  BlobsService(const BlobFolder& blobs, const BlobLimits& limits) : blobs_(blobs), limits_(limits) {}

  grpc::Status FindMissing(grpc::ServerContext*, const v1::FindMissingRequest* request,
                           v1::FindMissingResponse* response) override;
  grpc::Status Upload(grpc::ServerContext*, grpc::ServerReader<v1::UploadChunk>* reader,
                      v1::UploadResponse* response) override;
  grpc::Status Download(grpc::ServerContext*, const v1::DownloadRequest* request,
                        grpc::ServerWriter<v1::DownloadChunk>* writer) override;

 private:
  const BlobFolder& blobs_;
  BlobLimits limits_;
};

}  // namespace penumbra
