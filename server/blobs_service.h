#pragma once
#include "proto/blobs.grpc.pb.h"
#include "server/blob_transfer.h"

namespace penumbra {

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
