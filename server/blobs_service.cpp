#include "server/blobs_service.h"

#include "proto/rpc_status.h"

namespace penumbra {
<<<<<<< HEAD
namespace {

constexpr int kMostDigests = 100'000;

absl::Status check_digest(const std::string& digest) {
  if (!is_digest(digest)) return invalid_input("'{:.80}' is not a digest", digest);
  return absl::OkStatus();
}

absl::StatusOr<uint64_t> receive(const BlobFolder& blobs, const BlobLimits& limits,
                                 grpc::ServerReader<v1::UploadChunk>& reader) {
  v1::UploadChunk chunk;
  if (!reader.Read(&chunk)) return invalid_input("an upload without a chunk");
  RETURN_IF_ERROR(check_digest(chunk.digest()));
  RETURN_IF_ERROR(check_room(blobs, limits, chunk.digest(), chunk.size()));
  const uint64_t size = chunk.size();
  const bool flush = !chunk.flush_later();
  ASSIGN_OR_RETURN(const auto writer, blobs.write(chunk.digest(), chunk.size(), chunk.offset()));
  do {
    if (chunk.data().size() > kChunkBytes) return invalid_input("a chunk of more than {} bytes", kChunkBytes);
    RETURN_IF_ERROR(writer->append(chunk.data()));
  } while (reader.Read(&chunk));
  RETURN_IF_ERROR(writer->finish(flush));
  return size;
}

}  // namespace
=======
>>>>>>> proofs

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
