#pragma once
#include "proto/blob_folder.h"
#include "proto/blobs.grpc.pb.h"

namespace penumbra {

/// proto/blobs.proto over a folder. Translates only.
class BlobsService final : public v1::Blobs::Service {
 public:
  /// `most_bytes`: largest blob that is taken.
  BlobsService(const BlobFolder& blobs, uint64_t most_bytes) : blobs_(blobs), most_bytes_(most_bytes) {}

  grpc::Status FindMissing(grpc::ServerContext*, const v1::FindMissingRequest* request,
                           v1::FindMissingResponse* response) override;
  grpc::Status Upload(grpc::ServerContext*, grpc::ServerReader<v1::UploadChunk>* reader,
                      v1::UploadResponse* response) override;
  grpc::Status Download(grpc::ServerContext*, const v1::DownloadRequest* request,
                        grpc::ServerWriter<v1::DownloadChunk>* writer) override;

 private:
  const BlobFolder& blobs_;
  uint64_t most_bytes_;
};

}  // namespace penumbra
