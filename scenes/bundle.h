#pragma once
// A bundle is the set of files that a scene needs, immutable, addressed by the SHA-256 of its index.
#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "proto/job.h"
#include "proto/sha256.h"
#include "scenes/description.h"
#include "scenes/files.h"

namespace penumbra {

/// One file of a bundle: how the scene's text names it, and its content.
struct BundleEntry {
  std::string reference;  ///< as written in the scene, e.g. "../textures/x.png"
  std::string name;       ///< normalised, relative, inside the bundle, e.g. "up1/textures/x.png"
  Digest digest;
  uint64_t size = 0;
  bool operator==(const BundleEntry&) const = default;
};

struct BundleIndex {
  std::string main;                  ///< name of the main scene file's entry
  std::vector<BundleEntry> entries;  ///< sorted by name
  bool operator==(const BundleIndex&) const = default;
};

/// 10,000 files with long names have two megabytes.
inline constexpr uint64_t kMostIndexBytes = uint64_t{64} << 20;

/// Canonical JSON text of an index (its SHA-256 is the bundle's digest) and back. InvalidArgument for an
/// index whose names are absolute, contain `..`, are repeated, or are too many.
std::string serialize(const BundleIndex& index);
absl::StatusOr<BundleIndex> parse_bundle_index(std::string_view json);

/// Digest of a file's bytes.
absl::StatusOr<Digest> sha256_file(const std::string& path);

/// A bundle on the client's machine: the index and where each blob lies.
struct LocalBundle {
  BundleIndex index;
  std::vector<std::string> paths;  ///< parallel to index.entries
};

/// Collects every file that the scene names (includes, meshes, textures, spectra, maps). Missing
/// textures are left out (the renderer substitutes and warns); a missing mesh or include is an error.
absl::StatusOr<LocalBundle> make_bundle(const std::string& scene_path, const SceneDescription& description);

/// The files of a bundle in a content-addressed folder: <cache>/<first two hex digits>/<digest>.
class BundleFiles final : public SceneFiles {
 public:
  BundleFiles(BundleIndex index, std::string cache) : index_(std::move(index)), cache_(std::move(cache)) {}
  absl::StatusOr<std::string> path_of(std::string_view name) const override;

 private:
  BundleIndex index_;
  std::string cache_;
};

}  // namespace penumbra
