#include "scenes/files.h"

#include <algorithm>
#include <filesystem>
#include <system_error>

#include "proto/status.h"
#include "scenes/diagnostics.h"

namespace penumbra {

absl::StatusOr<std::string> FolderFiles::path_of(std::string_view name) const {
  namespace fs = std::filesystem;
  // A NUL would end the path early for the system, but not for us.
  if (name.empty() || name.find('\0') != std::string_view::npos) return invalid_input("not a file name");
  std::error_code fault;
  const auto exists = [&fault](const fs::path& path) { return fs::exists(path, fault) && !fault; };
  const fs::path path = fs::path(folder_) / fs::path(name);
  if (exists(path)) return path.string();
  // Exporters on Windows write backslashes.
  std::string slashes(name);
  std::replace(slashes.begin(), slashes.end(), '\\', '/');
  if (const fs::path other = fs::path(folder_) / slashes; slashes != name && exists(other))
    return other.string();
  return make_status(absl::StatusCode::kNotFound, "no such file: '{}'", printable(path.string()));
}

}  // namespace penumbra
