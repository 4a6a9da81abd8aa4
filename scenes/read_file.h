#pragma once
#include <string>
#include <string_view>

#include "absl/status/statusor.h"

namespace penumbra {

/// The bytes of a regular file; one whose first bytes are gzip's is unpacked. NotFound, or InvalidArgument
/// for what is no regular file, cannot be read, is damaged, or unpacks to more than 4 GiB. The message
/// does not repeat the path: the caller says where the name stood.
absl::StatusOr<std::string> read_file(const std::string& path);

/// At most the first `most` bytes of it, likewise, and the size of the whole file on disk.
struct FileHead {
  std::string bytes;
  uint64_t size_on_disk = 0;
  bool packed = false;  ///< gzip: size_on_disk says nothing about the length of the content
};
absl::StatusOr<FileHead> read_file_head(const std::string& path, size_t most);

}  // namespace penumbra
