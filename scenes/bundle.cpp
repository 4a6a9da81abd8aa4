#include "scenes/bundle.h"

#include <algorithm>
#include <filesystem>
#include <map>

#include "proto/status.h"
#include "scenes/bundle_names.h"
#include "scenes/diagnostics.h"
#include "scenes/file_references.h"

namespace penumbra {
namespace {

namespace fs = std::filesystem;

/// Files of a bundle while it grows, sorted by name.
class Collector {
 public:
  absl::Status add(const std::string& reference, const std::string& path) {
    const std::string name = bundle_name(reference);
    RETURN_IF_ERROR(check_bundle_name(name));
    const auto [file, fresh] = files_.try_emplace(name, File{reference, path});
    std::error_code fault;
    // `a/../b` and `b` differ where a is a symbolic link; a bundle has no links.
    if (!fresh && file->second.path != path && !fs::equivalent(file->second.path, path, fault))
      return invalid_input("'{}' and '{}' are different files, but one name in a bundle",
                           printable(file->second.reference), printable(reference));
    return absl::OkStatus();
  }

  absl::StatusOr<LocalBundle> finish(const std::string& main) const {
    LocalBundle bundle;
    bundle.index.main = bundle_name(main);
    for (const auto& [name, file] : files_) {
      ASSIGN_OR_RETURN(Digest digest, sha256_file(file.path));
      std::error_code fault;
      const uint64_t size = fs::file_size(file.path, fault);
      if (fault) return invalid_input("{}: {}", file.path, fault.message());
      bundle.index.entries.push_back({file.reference, name, std::move(digest), size});
      bundle.paths.push_back(file.path);
    }
    return bundle;
  }

 private:
  struct File {
    std::string reference, path;
  };
  std::map<std::string, File> files_;
};

}  // namespace

absl::StatusOr<LocalBundle> make_bundle(const std::string& scene_path, const SceneDescription& description) {
  const FolderFiles files(fs::path(scene_path).parent_path().string());
  Collector collector;
  for (const std::string& name : description.files) {
    const absl::StatusOr<std::string> path = files.path_of(name);
    if (!path.ok()) return invalid_input("{}: {}", printable(name), message_of(path.status()));
    RETURN_IF_ERROR(collector.add(name, *path));
  }
  for (const FileReference& reference : file_references(description)) {
    const absl::StatusOr<std::string> path = files.path_of(reference.name);
    std::error_code fault;
    const bool is_file = path.ok() && fs::is_regular_file(*path, fault);
    if (is_file)
      RETURN_IF_ERROR(collector.add(reference.name, *path));
    else if (reference.required)
      return invalid_input("{}: '{}': {}", description.place(reference.loc), printable(reference.name),
                           path.ok() ? "not a regular file" : message_of(path.status()));
  }
  return collector.finish(description.files.at(0));
}

absl::StatusOr<std::string> BundleFiles::path_of(std::string_view name) const {
  const auto find = [this](std::string_view wanted) -> const BundleEntry* {
    const auto entry = std::lower_bound(index_.entries.begin(), index_.entries.end(), wanted,
                                        [](const BundleEntry& e, std::string_view n) { return e.name < n; });
    return entry != index_.entries.end() && entry->name == wanted ? &*entry : nullptr;
  };
  const BundleEntry* const entry = name == index_.main ? find(name) : find(bundle_name(name));
  if (!entry)
    return make_status(absl::StatusCode::kNotFound, "no such file in the bundle: '{}'", printable(name));
  return fmt::format("{}/{}/{}", cache_, entry->digest.substr(0, 2), entry->digest);
}

}  // namespace penumbra
