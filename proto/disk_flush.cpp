#include "proto/disk_flush.h"

#include <fcntl.h>
#include <unistd.h>

#include <filesystem>

#include "proto/status.h"
#include "proto/system_error.h"

namespace penumbra {
namespace {

absl::Status flush_path(const std::string& path) {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) return system_error("opening", path);
  const absl::Status status = ::fsync(file) == 0 ? absl::OkStatus() : system_error("flushing", path);
  ::close(file);
  return status;
}

}  // namespace

absl::StatusOr<std::shared_ptr<DiskFlush>> DiskFlush::open(const std::string& folder, int (*syncfs)(int)) {
  const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return system_error("opening", folder);
  return std::shared_ptr<DiskFlush>(new DiskFlush(folder, descriptor, syncfs != nullptr ? syncfs : ::syncfs));
}

DiskFlush::~DiskFlush() {
  ::close(descriptor_);
}

absl::Status DiskFlush::flush_all() {
  const std::lock_guard lock(disk_);
  if (failure_.ok() && syncfs_(descriptor_) != 0) failure_ = system_error("flushing the disk of", folder_);
  return failure_;
}

absl::Status DiskFlush::flush(int file, const std::string& path) {
  std::unique_lock lock(mutex_);
  if (!next_) next_ = std::make_shared<Round>();
  const std::shared_ptr<Round> mine = next_;
  ++mine->waiting;
  over_.wait(lock, [&] { return mine->over || !busy_; });
  if (mine->over) return mine->status;
  busy_ = true;  // the first to see it flushes for all who have come meanwhile
  next_ = nullptr;
  const bool alone = mine->waiting == 1;
  lock.unlock();
  const absl::Status status = !alone               ? flush_all()
                              : ::fsync(file) == 0 ? absl::OkStatus()
                                                   : system_error("flushing", path);
  lock.lock();
  mine->status = status;
  mine->over = true;
  busy_ = false;
  over_.notify_all();
  return status;
}

absl::Status DiskFlush::flush(const std::vector<std::string>& files) {
  // The file, then its name: two flushes of the disk, where everything at once is one.
  for (const std::string& path : files)
    if (::access(path.c_str(), F_OK) != 0) return system_error("flushing", path);
  if (files.size() > 1) return flush_all();
  for (const std::string& path : files) {
    RETURN_IF_ERROR(flush_path(path));
    RETURN_IF_ERROR(flush_path(std::filesystem::path(path).parent_path()));
  }
  return absl::OkStatus();
}

}  // namespace penumbra
