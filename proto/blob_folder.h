#pragma once
// Immutable bytes by their SHA-256 in a folder, <root>/<first two hex digits>/<digest>: the server's store
// and the workers' cache. What is there under a digest has that digest: bytes are written to a temporary
// name, verified, made durable and renamed.
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "proto/disk_flush.h"
#include "proto/job.h"
#include "proto/sha256.h"

namespace penumbra {

/// 64 lower-case hexadecimal digits.
bool is_digest(std::string_view text);

/// What stored bytes survive: the end of every process and the loss of power (flushed to disk), or the former
/// alone.
enum class Durability { kPowerLoss, kProcessEnd };

/// Bytes on their way into a folder. If it is destroyed before finish(), what was written stays and can be
/// gone on with.
class BlobWriter {
 public:
  ~BlobWriter();
  BlobWriter(const BlobWriter&) = delete;
  BlobWriter& operator=(const BlobWriter&) = delete;

  /// InvalidArgument beyond the announced size; ResourceExhausted if the disk is full.
  absl::Status append(std::string_view bytes);
  /// Verifies, makes durable (unless BlobFolder::sync() will, or the folder's durability asks for no flush),
  /// renames. InvalidArgument if size or digest do not fit: bytes with another digest are thrown away.
  absl::Status finish(bool flush = true);
  /// Forgets what has been written: the next writer begins anew.
  void discard();

 private:
  friend class BlobFolder;
  BlobWriter(std::string path, std::string target, Digest digest, int file, uint64_t size,
             std::shared_ptr<DiskFlush> flush)
      : path_(std::move(path)),
        target_(std::move(target)),
        digest_(std::move(digest)),
        file_(file),
        size_(size),
        flush_(std::move(flush)) {}

  std::string path_, target_;
  Digest digest_;
  int file_;  ///< open and locked as long as the writer lives
  uint64_t size_, written_ = 0;
  std::shared_ptr<DiskFlush> flush_;  ///< null: the folder asks for none
  Sha256 hash_;
};

/// A blob as it lies in its folder.
struct BlobFile {
  Digest digest;
  uint64_t bytes = 0;
  double age_seconds = 0;  ///< since it was written or last touched
};

/// Safe for several threads and for several processes that share the folder.
class BlobFolder {
 public:
  /// Makes the folder if need be; unfinished files that nobody has touched for a day go.
  static absl::StatusOr<BlobFolder> open(const std::string& root,
                                         Durability durability = Durability::kPowerLoss);

  const std::string& root() const { return root_; }
  /// Requires is_digest(digest): no other name ever reaches the disk.
  std::string path_of(const Digest& digest) const;
  /// Size of the blob; none if it is not there.
  std::optional<uint64_t> size(const Digest& digest) const;
  /// Bytes of an unfinished writer that can be gone on with.
  uint64_t partial(const Digest& digest) const;

  /// The whole blob as it lies there. NotFound.
  absl::StatusOr<std::string> read_unverified(const Digest& digest) const;
  /// The whole blob, verified. NotFound; DataLoss if the bytes no longer have the digest: the file is then
  /// removed, so that it can be stored anew.
  absl::StatusOr<std::string> read(const Digest& digest) const;

  /// Reads the blob and compares. As read(), without keeping the bytes.
  absl::Status verify(const Digest& digest) const;

  /// Says that somebody still counts on the blob; false if it is not there.
  bool touch(const Digest& digest) const;
  /// Removes what has been kept of uploads that nobody has gone on with for a day.
  void drop_stale_partials() const;
  /// Visits every blob, in no order.
  absl::Status each(const std::function<void(const BlobFile&)>& visit) const;
  /// Removes a blob; harmless if it is not there.
  void remove(const Digest& digest) const;
  /// Bytes that the disk of the folder has left for us; 0 if it does not say.
  uint64_t free_bytes() const;

  /// Stores bytes; harmless if they are there. Durable only after sync().
  absl::Status put(const Digest& digest, std::string_view bytes) const;
  /// Bytes and names of these blobs are as durable as the folder's durability says when this returns.
  absl::Status sync(const std::vector<Digest>& digests) const;

  /// A writer from `offset` on. FailedPrecondition if that is beyond what is kept (0 starts anew); Aborted
  /// while another writer has the same blob.
  absl::StatusOr<std::unique_ptr<BlobWriter>> write(const Digest& digest, uint64_t size,
                                                    uint64_t offset) const;

 private:
  BlobFolder(std::string root, std::shared_ptr<DiskFlush> flush)
      : root_(std::move(root)), flush_(std::move(flush)) {}
  std::string partial_path(const Digest& digest) const;

  std::string root_;
  std::shared_ptr<DiskFlush> flush_;  ///< null: no flush is asked for
};

}  // namespace penumbra
