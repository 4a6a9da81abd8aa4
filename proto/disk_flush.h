#pragma once
// Makes files durable, together where several are waiting: a disk takes a few milliseconds for each flush,
// however much it flushes.
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace penumbra {

/// Of one folder's file system. Safe for several threads.
class DiskFlush {
 public:
  /// Keeps the folder open: the kernel tells an open file of every failed write since (syncfs(2)).
  /// `syncfs`: the system's, but for tests.
  static absl::StatusOr<std::shared_ptr<DiskFlush>> open(const std::string& folder,
                                                         int (*syncfs)(int) = nullptr);
  ~DiskFlush();
  DiskFlush(const DiskFlush&) = delete;
  DiskFlush& operator=(const DiskFlush&) = delete;

  /// One file or folder that is open: by itself if nobody else waits, else with all that do.
  absl::Status flush(int file, const std::string& path);
  /// All of these files, with the folders that hold their names.
  absl::Status flush(const std::vector<std::string>& files);

 private:
  DiskFlush(std::string folder, int descriptor, int (*syncfs)(int))
      : folder_(std::move(folder)), descriptor_(descriptor), syncfs_(syncfs) {}
  /// Everything that was written to the file system before the call. The kernel tells of a failed write once,
  /// to whoever asks first: so a failure is kept, and all later calls fail as well, until the program is
  /// started anew and looks at what the disk has.
  absl::Status flush_all();

  /// Threads that wait for the same flush.
  struct Round {
    int waiting = 0;
    bool over = false;
    absl::Status status;
  };

  std::string folder_;
  int descriptor_;
  int (*syncfs_)(int);
  std::mutex disk_;       // one flush of everything at a time
  absl::Status failure_;  // guarded by disk_
  std::mutex mutex_;
  std::condition_variable over_;
  bool busy_ = false;  // guarded by mutex_
  std::shared_ptr<Round>
      next_;  // guarded by mutex_: those who have come since the flush that is under way began
};

}  // namespace penumbra
