#pragma once
// Where the files that a scene names come from: a folder on the client, a bundle on a worker.
#include <string>
#include <string_view>

#include "absl/status/statusor.h"

namespace penumbra {

class SceneFiles {
 public:
  virtual ~SceneFiles() = default;
  /// A readable path for a name as the scene's text has it ("models/a.ply", "../textures/x.png").
  /// Names resolve against the main file's folder, also from included files. NotFound if there is none.
  virtual absl::StatusOr<std::string> path_of(std::string_view name) const = 0;
};

/// Files below (or beside) the main scene file on this machine.
class FolderFiles final : public SceneFiles {
 public:
  explicit FolderFiles(std::string folder) : folder_(std::move(folder)) {}
  absl::StatusOr<std::string> path_of(std::string_view name) const override;

 private:
  std::string folder_;
};

}  // namespace penumbra
