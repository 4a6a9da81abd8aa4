#include "server/blobs_service.h"

#include <fstream>
#include <set>

#include "proto/channel.h"
#include "proto/rpc_status.h"

namespace penumbra {
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

grpc::Status BlobsService::FindMissing(grpc::ServerContext*, const v1::FindMissingRequest* request,
                                       v1::FindMissingResponse* response) {
  if (request->digests_size() > kMostDigests)
    return to_grpc(invalid_input("digests: more than {}", kMostDigests));
  std::set<std::string> seen;
  for (const std::string& digest : request->digests()) {
    if (const absl::Status status = check_digest(digest); !status.ok()) return to_grpc(status);
    if (!seen.insert(digest).second || blobs_.touch(digest)) continue;
    v1::FindMissingResponse::Missing* missing = response->add_missing();
    missing->set_digest(digest);
    missing->set_partial(blobs_.partial(digest));
  }
  return grpc::Status::OK;
}

grpc::Status BlobsService::Upload(grpc::ServerContext*, grpc::ServerReader<v1::UploadChunk>* reader,
                                  v1::UploadResponse* response) {
  const absl::StatusOr<uint64_t> size = receive(blobs_, limits_, *reader);
  if (size.ok()) response->set_size(*size);
  return to_grpc(size.status());
}

grpc::Status BlobsService::Download(grpc::ServerContext*, const v1::DownloadRequest* request,
                                    grpc::ServerWriter<v1::DownloadChunk>* writer) {
  if (const absl::Status status = check_digest(request->digest()); !status.ok()) return to_grpc(status);
  std::ifstream in(blobs_.path_of(request->digest()), std::ios::binary | std::ios::ate);
  if (!in) return grpc::Status(grpc::StatusCode::NOT_FOUND, "no blob " + request->digest());
  const auto size = static_cast<uint64_t>(in.tellg());
  if (request->offset() > size) return grpc::Status(grpc::StatusCode::OUT_OF_RANGE, "offset beyond the end");
  in.seekg(static_cast<std::streamoff>(request->offset()));
  Sha256 hash;
  for (uint64_t left = size - request->offset(); left > 0;) {
    v1::DownloadChunk chunk;
    chunk.mutable_data()->resize(std::min<uint64_t>(left, kChunkBytes));
    if (!in.read(chunk.mutable_data()->data(), static_cast<std::streamsize>(chunk.data().size())))
      return grpc::Status(grpc::StatusCode::DATA_LOSS, "the blob ends early: " + request->digest());
    left -= chunk.data().size();
    if (request->offset() == 0) hash.add(chunk.data());
    if (!writer->Write(chunk)) return grpc::Status(grpc::StatusCode::CANCELLED, "the reader has hung up");
  }
  // Whoever gets it will see the same; here the file goes, so that it can be uploaded anew.
  if (request->offset() == 0 && hash.hex() != request->digest())
    return to_grpc(blobs_.verify(request->digest()));
  return grpc::Status::OK;
}

}  // namespace penumbra
