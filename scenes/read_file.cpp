#include "scenes/read_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <memory>

#include "proto/status.h"

namespace penumbra {
namespace {

// A few megabytes of gzip can say «four gigabytes of zeros»; no mesh or text of a scene needs more.
constexpr uint64_t kMostUnpacked = uint64_t{4} << 30;
constexpr size_t kStep = size_t{1} << 20;

class File {
 public:
  explicit File(const std::string& path) : fd_(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)) {}
  File(const File&) = delete;
  File& operator=(const File&) = delete;
  ~File() {
    if (fd_ >= 0) ::close(fd_);
  }
  bool is_open() const { return fd_ >= 0; }
  int fd() const { return fd_; }

 private:
  int fd_;
};

absl::Status system_fault() {
  const int code = errno;
  return make_status(
      code == ENOENT || code == ENOTDIR ? absl::StatusCode::kNotFound : absl::StatusCode::kInvalidArgument,
      "{}", std::strerror(code));
}

/// Size of a regular file. (A pipe or a device may never end.)
absl::StatusOr<uint64_t> size_of(const File& file) {
  if (!file.is_open()) return system_fault();
  struct stat info {};
  if (::fstat(file.fd(), &info) != 0) return system_fault();
  if (!S_ISREG(info.st_mode)) return invalid_input("not a regular file");
  return static_cast<uint64_t>(info.st_size);
}

absl::StatusOr<std::string> read_bytes(const File& file, uint64_t count) {
  std::string bytes(count, '\0');
  uint64_t done = 0;
  while (done < count) {
    const ssize_t n = ::read(file.fd(), bytes.data() + done, count - done);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return system_fault();
    if (n == 0) break;  // it became shorter since fstat
    done += static_cast<uint64_t>(n);
  }
  bytes.resize(done);
  return bytes;
}

bool is_gzip(std::string_view bytes) {
  return bytes.starts_with("\x1f\x8b");
}

struct InflateEnd {
  void operator()(z_stream* stream) const { inflateEnd(stream); }
};

enum class Extent { kWhole, kHead };

/// kWhole: all members of a gzip file, an error if they are longer than `most` bytes. kHead: what its
/// beginning unpacks to, at most `most` bytes; it may break off anywhere.
absl::StatusOr<std::string> unpack(std::string_view packed, uint64_t most, Extent extent) {
  const bool head = extent == Extent::kHead;
  z_stream stream{};
  constexpr int kGzipOnly = 16 + MAX_WBITS;
  if (inflateInit2(&stream, kGzipOnly) != Z_OK) return invalid_input("zlib does not start");
  const std::unique_ptr<z_stream, InflateEnd> guard(&stream);
  std::string out;
  size_t done = 0;
  for (;;) {
    if (stream.avail_in == 0) {
      const size_t n = std::min(packed.size(), kStep);
      stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data()));
      stream.avail_in = static_cast<uInt>(n);
      packed.remove_prefix(n);
    }
    if (out.size() - done < kStep) out.resize(std::max(2 * out.size(), done + kStep));
    const size_t room = std::min(out.size() - done, size_t{1} << 30);
    stream.next_out = reinterpret_cast<Bytef*>(out.data() + done);
    stream.avail_out = static_cast<uInt>(room);
    const int result = inflate(&stream, Z_NO_FLUSH);
    done += room - stream.avail_out;
    if (result != Z_OK && result != Z_STREAM_END && result != Z_BUF_ERROR)
      return invalid_input("damaged gzip data");
    if (head && done >= most) break;
    if (done > most) return invalid_input("unpacks to more than {} bytes", most);
    const bool input_over = stream.avail_in == 0 && packed.empty();
    if (result == Z_STREAM_END) {
      if (input_over) break;
      if (inflateReset(&stream) != Z_OK) return invalid_input("damaged gzip data");
    } else if (input_over && stream.avail_out != 0) {
      if (head) break;
      return invalid_input("truncated gzip data");
    }
  }
  out.resize(std::min<uint64_t>(done, most));
  return out;
}

}  // namespace

absl::StatusOr<std::string> read_file(const std::string& path) {
  const File file(path);
  ASSIGN_OR_RETURN(const uint64_t size, size_of(file));
  absl::StatusOr<std::string> bytes = read_bytes(file, size);
  if (!bytes.ok() || !is_gzip(*bytes)) return bytes;
  return unpack(*bytes, kMostUnpacked, Extent::kWhole);
}

absl::StatusOr<FileHead> read_file_head(const std::string& path, size_t most) {
  const File file(path);
  FileHead head;
  ASSIGN_OR_RETURN(head.size_on_disk, size_of(file));
  ASSIGN_OR_RETURN(head.bytes, read_bytes(file, std::min<uint64_t>(head.size_on_disk, most)));
  head.packed = is_gzip(head.bytes);
  if (!head.packed) return head;
  ASSIGN_OR_RETURN(head.bytes, unpack(head.bytes, most, Extent::kHead));
  return head;
}

}  // namespace penumbra
