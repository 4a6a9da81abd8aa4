#include "proto/blob_folder.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <filesystem>

#include "proto/status.h"
#include "proto/system_error.h"

namespace penumbra {
namespace {

namespace fs = std::filesystem;

/// A file descriptor that closes itself.
class File {
 public:
  File(const std::string& path, int flags) : descriptor_(::open(path.c_str(), flags | O_CLOEXEC, 0644)) {}
  ~File() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  File(const File&) = delete;
  File& operator=(const File&) = delete;
  bool ok() const { return descriptor_ >= 0; }
  int get() const { return descriptor_; }
  int release() { return std::exchange(descriptor_, -1); }

 private:
  int descriptor_;
};

absl::Status write_all(int file, std::string_view bytes, const std::string& path) {
  while (!bytes.empty()) {
    const ssize_t n = ::write(file, bytes.data(), bytes.size());
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return system_error("writing", path);
    bytes.remove_prefix(static_cast<size_t>(n));
  }
  return absl::OkStatus();
}

/// Calls take(piece) for pieces of the first `size` bytes.
template <class Take>
absl::Status read_pieces(int file, uint64_t size, const std::string& path, Take take) {
  std::string buffer(std::min<uint64_t>(size, 1 << 20), '\0');
  for (uint64_t offset = 0; offset < size;) {
    const ssize_t n = ::pread(file, buffer.data(), std::min<uint64_t>(buffer.size(), size - offset),
                              static_cast<off_t>(offset));
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return system_error("reading", path);
    if (n == 0) return make_status(absl::StatusCode::kDataLoss, "{}: ends early", path);
    take(std::string_view(buffer.data(), static_cast<size_t>(n)));
    offset += static_cast<uint64_t>(n);
  }
  return absl::OkStatus();
}

absl::Status rename_to(const std::string& from, const std::string& to) {
  if (::rename(from.c_str(), to.c_str()) != 0) return system_error("renaming to", to);
  return absl::OkStatus();
}

/// A file whose bytes no longer have its name goes, so that it can be stored anew.
absl::Status corrupt(const std::string& path) {
  ::unlink(path.c_str());
  return make_status(absl::StatusCode::kDataLoss, "{}: its bytes no longer have the digest; removed", path);
}

}  // namespace

bool is_digest(std::string_view text) {
  return text.size() == 64 && text.find_first_not_of("0123456789abcdef") == std::string_view::npos;
}

BlobWriter::~BlobWriter() {
  ::close(file_);
}

absl::Status BlobWriter::append(std::string_view bytes) {
  if (bytes.size() > size_ - written_)
    return invalid_input("blob {}: more than the announced {} bytes", digest_, size_);
  RETURN_IF_ERROR(write_all(file_, bytes, path_));
  hash_.add(bytes);
  // What a disk still has to write of a large blob, results that are flushed meanwhile would have to wait
  // for: it begins at once.
  constexpr uint64_t kLarge = 1 << 20;
  if (flush_ != nullptr && size_ >= kLarge)
    (void)::sync_file_range(file_, static_cast<off64_t>(written_), static_cast<off64_t>(bytes.size()),
                            SYNC_FILE_RANGE_WRITE);
  written_ += bytes.size();
  return absl::OkStatus();
}

void BlobWriter::discard() {
  ::unlink(path_.c_str());
}

absl::Status BlobWriter::finish(bool flush) {
  if (written_ != size_)
    return invalid_input("blob {}: {} bytes came, {} were announced", digest_, written_, size_);
  if (const std::string found = hash_.hex(); found != digest_) {
    ::unlink(path_.c_str());
    return invalid_input("blob {}: its bytes have the digest {}", digest_, found);
  }
  flush = flush && flush_ != nullptr;
  if (flush) RETURN_IF_ERROR(flush_->flush(file_, path_));
  RETURN_IF_ERROR(rename_to(path_, target_));
  if (!flush) return absl::OkStatus();
  const std::string folder = fs::path(target_).parent_path();
  const File names(folder, O_RDONLY);
  if (!names.ok()) return system_error("opening", folder);
  return flush_->flush(names.get(), folder);
}

absl::StatusOr<BlobFolder> BlobFolder::open(const std::string& root, Durability durability) {
  std::error_code error;
  fs::create_directories(root + "/partial", error);
  if (error) return invalid_input("{}: {}", root, error.message());
  if (::access((root + "/partial").c_str(), W_OK) != 0) return invalid_input("{}: not writable", root);
  BlobFolder(root, nullptr).drop_stale_partials();
  // All folders at once, so that storing a blob makes no new one whose parent would have to be flushed.
  for (int prefix = 0; prefix < 256; ++prefix)
    fs::create_directory(fmt::format("{}/{:02x}", root, prefix), error);
  if (durability == Durability::kProcessEnd) return BlobFolder(root, nullptr);
  ASSIGN_OR_RETURN(auto flush, DiskFlush::open(root));
  const File names(root, O_RDONLY);
  if (!names.ok()) return system_error("opening", root);
  RETURN_IF_ERROR(flush->flush(names.get(), root));
  return BlobFolder(root, std::move(flush));
}

void BlobFolder::drop_stale_partials() const {
  std::error_code error;
  const auto limit = fs::file_time_type::clock::now() - std::chrono::hours(24);
  for (const fs::directory_entry& entry : fs::directory_iterator(root_ + "/partial", error)) {
    const auto written = fs::last_write_time(entry.path(), error);
    if (!error && written < limit) fs::remove(entry.path(), error);
  }
}

std::string BlobFolder::path_of(const Digest& digest) const {
  PENUMBRA_CHECK(is_digest(digest));
  return root_ + "/" + digest.substr(0, 2) + "/" + digest;
}

std::string BlobFolder::partial_path(const Digest& digest) const {
  PENUMBRA_CHECK(is_digest(digest));
  return root_ + "/partial/" + digest;
}

std::optional<uint64_t> BlobFolder::size(const Digest& digest) const {
  struct stat info {};
  if (::stat(path_of(digest).c_str(), &info) != 0) return std::nullopt;
  return static_cast<uint64_t>(info.st_size);
}

uint64_t BlobFolder::partial(const Digest& digest) const {
  struct stat info {};
  return ::stat(partial_path(digest).c_str(), &info) == 0 ? static_cast<uint64_t>(info.st_size) : 0;
}

absl::StatusOr<std::string> BlobFolder::read_unverified(const Digest& digest) const {
  const std::string path = path_of(digest);
  const File file(path, O_RDONLY);
  struct stat info {};
  if (!file.ok() || ::fstat(file.get(), &info) != 0) return system_error("blob", path);
  std::string bytes(static_cast<size_t>(info.st_size), '\0');
  for (size_t offset = 0; offset < bytes.size();) {
    const ssize_t n =
        ::pread(file.get(), bytes.data() + offset, bytes.size() - offset, static_cast<off_t>(offset));
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return system_error("reading", path);
    if (n == 0) return make_status(absl::StatusCode::kDataLoss, "{}: ends early", path);
    offset += static_cast<size_t>(n);
  }
  return bytes;
}

absl::StatusOr<std::string> BlobFolder::read(const Digest& digest) const {
  ASSIGN_OR_RETURN(std::string bytes, read_unverified(digest));
  if (sha256(bytes) == digest) return bytes;
  return corrupt(path_of(digest));
}

absl::Status BlobFolder::verify(const Digest& digest) const {
  const std::string path = path_of(digest);
  const File file(path, O_RDONLY);
  struct stat info {};
  if (!file.ok() || ::fstat(file.get(), &info) != 0) return system_error("blob", path);
  Sha256 hash;
  RETURN_IF_ERROR(read_pieces(file.get(), static_cast<uint64_t>(info.st_size), path,
                              [&](std::string_view piece) { hash.add(piece); }));
  return hash.hex() == digest ? absl::OkStatus() : corrupt(path);
}

bool BlobFolder::touch(const Digest& digest) const {
  return ::utimensat(AT_FDCWD, path_of(digest).c_str(), nullptr, 0) == 0;
}

absl::Status BlobFolder::each(const std::function<void(const BlobFile&)>& visit) const {
  timespec now{};
  ::clock_gettime(CLOCK_REALTIME, &now);
  for (int prefix = 0; prefix < 256; ++prefix) {
    const std::string folder = fmt::format("{}/{:02x}", root_, prefix);
    std::error_code error;
    for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
      const std::string name = it->path().filename();
      struct stat info {};
      if (!is_digest(name) || ::stat(it->path().c_str(), &info) != 0) continue;  // gone meanwhile
      visit(
          {name, static_cast<uint64_t>(info.st_size), static_cast<double>(now.tv_sec - info.st_mtim.tv_sec)});
    }
    if (error) return make_status(absl::StatusCode::kInternal, "reading {}: {}", folder, error.message());
  }
  return absl::OkStatus();
}

void BlobFolder::remove(const Digest& digest) const {
  ::unlink(path_of(digest).c_str());
}

uint64_t BlobFolder::free_bytes() const {
  struct statvfs info {};
  if (::statvfs(root_.c_str(), &info) != 0) return 0;
  return static_cast<uint64_t>(info.f_bavail) * info.f_frsize;
}

absl::Status BlobFolder::put(const Digest& digest, std::string_view bytes) const {
  if (!is_digest(digest)) return invalid_input("'{:.80}' is not a digest", digest);
  if (sha256(bytes) != digest) return invalid_input("blob {}: its bytes have another digest", digest);
  if (size(digest) == bytes.size()) return absl::OkStatus();
  static std::atomic<uint64_t> counter{0};
  const std::string temporary = fmt::format("{}/partial/put-{}-{}", root_, ::getpid(), counter++);
  {
    const File file(temporary, O_WRONLY | O_CREAT | O_EXCL);
    if (!file.ok()) return system_error("creating", temporary);
    if (absl::Status status = write_all(file.get(), bytes, temporary); !status.ok()) {
      ::unlink(temporary.c_str());
      return status;
    }
  }
  return rename_to(temporary, path_of(digest));
}

absl::Status BlobFolder::sync(const std::vector<Digest>& digests) const {
  if (flush_ == nullptr || digests.empty()) return absl::OkStatus();
  std::vector<std::string> files;
  for (const Digest& digest : digests) files.push_back(path_of(digest));
  return flush_->flush(files);
}

absl::StatusOr<std::unique_ptr<BlobWriter>> BlobFolder::write(const Digest& digest, uint64_t size,
                                                              uint64_t offset) const {
  if (!is_digest(digest)) return invalid_input("'{:.80}' is not a digest", digest);
  const std::string path = partial_path(digest);
  File file(path, O_RDWR | O_CREAT);
  if (!file.ok()) return system_error("opening", path);
  // The lock ends with the descriptor, whatever becomes of the process. A file that was renamed between
  // open and lock belongs to a finished blob and must not be written to.
  struct stat mine {
  }, named{};
  const bool locked = ::flock(file.get(), LOCK_EX | LOCK_NB) == 0 && ::fstat(file.get(), &mine) == 0 &&
                      ::stat(path.c_str(), &named) == 0 && mine.st_ino == named.st_ino;
  if (!locked)
    return make_status(absl::StatusCode::kAborted, "blob {} is being written by somebody else", digest);
  if (offset > size || offset > static_cast<uint64_t>(mine.st_size))
    return make_status(absl::StatusCode::kFailedPrecondition, "blob {}: offset {} of {} bytes kept", digest,
                       offset, mine.st_size);
  if (::ftruncate(file.get(), static_cast<off_t>(offset)) != 0) return system_error("truncating", path);
  std::unique_ptr<BlobWriter> writer(new BlobWriter(path, path_of(digest), digest, file.get(), size, flush_));
  const int descriptor = file.release();
  RETURN_IF_ERROR(
      read_pieces(descriptor, offset, path, [&](std::string_view piece) { writer->hash_.add(piece); }));
  writer->written_ = offset;
  if (::lseek(descriptor, static_cast<off_t>(offset), SEEK_SET) < 0) return system_error("seeking", path);
  return writer;
}

}  // namespace penumbra
