#include "worker/agent/blob_client.h"

#include <algorithm>
#include <chrono>
#include <thread>

#include "proto/channel.h"
#include "proto/rpc_status.h"
#include "scenes/bundle.h"

namespace penumbra {
namespace {

/// What the server sent is not what it was asked for: its disk's fault, not the scene's.
absl::Status sent_corrupt(const absl::Status& status) {
  return make_status(absl::StatusCode::kDataLoss, "the server sent {}", message_of(status));
}

}  // namespace

absl::Status BlobClient::upload(const Digest& digest, std::string_view bytes) const {
  grpc::ClientContext context;
  v1::UploadResponse response;
  const auto writer = stub_->Upload(&context, &response);
  v1::UploadChunk chunk;
  chunk.set_digest(digest);
  chunk.set_size(bytes.size());
  chunk.set_flush_later(true);
  do {
    const std::string_view piece = bytes.substr(0, kChunkBytes);
    bytes.remove_prefix(piece.size());
    chunk.set_data(piece.data(), piece.size());
    if (!writer->Write(chunk)) break;  // the server has made up its mind; Finish says why
    chunk.Clear();
  } while (!bytes.empty());
  writer->WritesDone();
  return from_grpc(writer->Finish());
}

absl::Status BlobClient::download(const Digest& digest, uint64_t size, const BlobFolder& folder) const {
  const uint64_t kept = folder.partial(digest);
  const uint64_t offset = kept <= size ? kept : 0;
  ASSIGN_OR_RETURN(const auto writer, folder.write(digest, size, offset));
  grpc::ClientContext context;
  v1::DownloadRequest request;
  request.set_digest(digest);
  request.set_offset(offset);
  const auto reader = stub_->Download(&context, request);
  v1::DownloadChunk chunk;
  absl::Status status;
  while (status.ok() && reader->Read(&chunk)) status = writer->append(chunk.data());
  if (!status.ok()) context.TryCancel();
  const absl::Status received = from_grpc(reader->Finish());
  RETURN_IF_ERROR(status);
  // The server has found its own bytes bad: those that came are not worth going on from.
  if (absl::IsDataLoss(received)) writer->discard();
  RETURN_IF_ERROR(received);
  const absl::Status finished = writer->finish();
  return absl::IsInvalidArgument(finished) ? sent_corrupt(finished) : finished;
}

/// Other processes and the disk have had the cache since: read once in this process before it is believed.
bool BlobClient::whole(const Digest& digest, const BlobFolder& folder) const {
  {
    const std::lock_guard lock(mutex_);
    if (verified_.contains(digest)) return true;
  }
  if (!folder.verify(digest).ok()) return false;  // and it is gone: fetch it again
  const std::lock_guard lock(mutex_);
  verified_.insert(digest);
  return true;
}

absl::Status BlobClient::fetch(const Digest& digest, uint64_t size, const BlobFolder& folder) const {
  for (;;) {
    if (folder.size(digest) == size && whole(digest, folder)) return absl::OkStatus();
    const absl::Status status = download(digest, size, folder);
    if (!absl::IsAborted(status)) return status;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
}

absl::StatusOr<std::string> BlobClient::fetch_small(const Digest& digest, const BlobFolder& folder) const {
  if (folder.size(digest)) {
    absl::StatusOr<std::string> kept = folder.read(digest);
    if (kept.ok()) return kept;  // else it was corrupt and is gone: fetch it again
  }
  grpc::ClientContext context;
  v1::DownloadRequest request;
  request.set_digest(digest);
  const auto reader = stub_->Download(&context, request);
  std::string bytes;
  for (v1::DownloadChunk chunk; reader->Read(&chunk);) {
    bytes += chunk.data();
    if (bytes.size() > kMostIndexBytes) {
      context.TryCancel();
      return invalid_input("blob {}: more than {} bytes", digest, kMostIndexBytes);
    }
  }
  RETURN_IF_ERROR(from_grpc(reader->Finish()));
  const absl::Status kept = folder.put(digest, bytes);
  if (absl::IsInvalidArgument(kept)) return sent_corrupt(kept);
  RETURN_IF_ERROR(kept);
  return bytes;
}

}  // namespace penumbra
