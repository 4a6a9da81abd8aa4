#include "server/blob_transfer.h"

#include <fstream>
#include <set>

#include "proto/channel.h"
#include "proto/status.h"

namespace penumbra {
namespace {

constexpr int kMostDigests = 100'000;

absl::Status check_digest(const std::string& digest) {
  if (!is_digest(digest)) return invalid_input("'{:.80}' is not a digest", digest);
  return absl::OkStatus();
}

}  // namespace

absl::Status check_room(const BlobFolder& blobs, const BlobLimits& limits, const Digest& digest,
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

absl::StatusOr<v1::FindMissingResponse> missing_blobs(const BlobFolder& blobs,
                                                      const v1::FindMissingRequest& request) {
  if (request.digests_size() > kMostDigests) return invalid_input("digests: more than {}", kMostDigests);
  v1::FindMissingResponse response;
  std::set<std::string> seen;
  for (const std::string& digest : request.digests()) {
    RETURN_IF_ERROR(check_digest(digest));
    if (!seen.insert(digest).second || blobs.touch(digest)) continue;
    v1::FindMissingResponse::Missing* missing = response.add_missing();
    missing->set_digest(digest);
    missing->set_partial(blobs.partial(digest));
  }
  return response;
}

absl::StatusOr<uint64_t> receive_blob(const BlobFolder& blobs, const BlobLimits& limits,
                                      const std::function<bool(v1::UploadChunk&)>& read) {
  v1::UploadChunk chunk;
  if (!read(chunk)) return invalid_input("an upload without a chunk");
  RETURN_IF_ERROR(check_digest(chunk.digest()));
  RETURN_IF_ERROR(check_room(blobs, limits, chunk.digest(), chunk.size()));
  const Digest digest = chunk.digest();
  const uint64_t size = chunk.size();
  const bool flush = !chunk.flush_later();
  ASSIGN_OR_RETURN(const auto writer, blobs.write(chunk.digest(), chunk.size(), chunk.offset()));
  do {
    if (chunk.data().size() > kChunkBytes) return invalid_input("a chunk of more than {} bytes", kChunkBytes);
    // Others write to the same disk while this arrives. What is kept of it can be gone on from.
    RETURN_IF_ERROR(check_room(blobs, limits, digest, chunk.data().size()));
    RETURN_IF_ERROR(writer->append(chunk.data()));
  } while (read(chunk));
  RETURN_IF_ERROR(writer->finish(flush));
  return size;
}

absl::Status send_blob(const BlobFolder& blobs, const v1::DownloadRequest& request,
                       const std::function<bool(const v1::DownloadChunk&)>& write) {
  const std::string& digest = request.digest();
  RETURN_IF_ERROR(check_digest(digest));
  std::ifstream in(blobs.path_of(digest), std::ios::binary | std::ios::ate);
  if (!in) return make_status(absl::StatusCode::kNotFound, "no blob {}", digest);
  const auto size = static_cast<uint64_t>(in.tellg());
  if (request.offset() > size)
    return make_status(absl::StatusCode::kOutOfRange, "offset {} is beyond the end of blob {}",
                       request.offset(), digest);
  in.seekg(static_cast<std::streamoff>(request.offset()));
  Sha256 hash;
  for (uint64_t left = size - request.offset(); left > 0;) {
    v1::DownloadChunk chunk;
    chunk.mutable_data()->resize(std::min<uint64_t>(left, kChunkBytes));
    if (!in.read(chunk.mutable_data()->data(), static_cast<std::streamsize>(chunk.data().size())))
      return make_status(absl::StatusCode::kDataLoss, "the blob ends early: {}", digest);
    left -= chunk.data().size();
    if (request.offset() == 0) hash.add(chunk.data());
    if (!write(chunk)) return absl::CancelledError("the reader has hung up");
  }
  // Whoever gets it will see the same; here the file goes, so that it can be uploaded anew.
  if (request.offset() == 0 && hash.hex() != digest) return blobs.verify(digest);
  return absl::OkStatus();
}

}  // namespace penumbra
