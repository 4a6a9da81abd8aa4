#pragma once
#include <string>

#include "absl/status/statusor.h"

namespace penumbra {

/// The folder given by --store, held by this process alone as long as the object lives: two servers with
/// one store would both lease the same tiles. The lock ends with the process, however it ends.
class StoreFolder {
 public:
  /// Makes the folder if need be. InvalidArgument: not a writable folder, or in use by another server.
  static absl::StatusOr<StoreFolder> open(const std::string& path);
  StoreFolder(StoreFolder&& other) noexcept;
  StoreFolder& operator=(StoreFolder&&) = delete;
  ~StoreFolder();

  std::string database() const { return path_ + "/jobs.sqlite"; }
  std::string blobs() const { return path_ + "/blobs"; }

 private:
  StoreFolder(std::string path, int lock) : path_(std::move(path)), lock_(lock) {}
  std::string path_;
  int lock_;
};

}  // namespace penumbra
