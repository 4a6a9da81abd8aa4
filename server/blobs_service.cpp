#include "server/blobs_service.h"

#include "proto/rpc_status.h"

namespace penumbra {

grpc::Status BlobsService::FindMissing(grpc::ServerContext*, const v1::FindMissingRequest* request,
                                       v1::FindMissingResponse* response) {
  absl::StatusOr<v1::FindMissingResponse> missing = missing_blobs(blobs_, *request);
  if (missing.ok()) *response = *std::move(missing);
  return to_grpc(missing.status());
}

grpc::Status BlobsService::Upload(grpc::ServerContext*, grpc::ServerReader<v1::UploadChunk>* reader,
                                  v1::UploadResponse* response) {
  const absl::StatusOr<uint64_t> size =
      receive_blob(blobs_, limits_, [&](v1::UploadChunk& chunk) { return reader->Read(&chunk); });
  if (size.ok()) response->set_size(*size);
  return to_grpc(size.status());
}

grpc::Status BlobsService::Download(grpc::ServerContext*, const v1::DownloadRequest* request,
                                    grpc::ServerWriter<v1::DownloadChunk>* writer) {
  return to_grpc(
      send_blob(blobs_, *request, [&](const v1::DownloadChunk& chunk) { return writer->Write(chunk); }));
}

}  // namespace penumbra
