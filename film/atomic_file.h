#pragma once
#include <string>
#include <string_view>

#include "absl/status/status.h"

namespace penumbra {

/// Writes `path` whole or not at all: to `path.partial`, flushed to the disk, then renamed. The error
/// (a full disk, a folder that is missing or read-only) names the path and the system's reason; an
/// existing file stays as it was, and no partial file stays behind.
absl::Status write_file_atomically(const std::string& path, std::string_view bytes);

}  // namespace penumbra
