#pragma once
#include <string>

#include "absl/status/statusor.h"
#include "scenes/description.h"
#include "scenes/files.h"

namespace penumbra {

/// Reads pbrt-v3 and pbrt-v4 text into a description; follows Include and Import through `files`.
/// Errors are `file:line:column: message` (InvalidArgument); never a partial description.
absl::StatusOr<SceneDescription> parse_scene(const std::string& main_name, const SceneFiles& files);

/// For a scene on this machine: main file by path.
absl::StatusOr<SceneDescription> parse_scene_file(const std::string& path);

}  // namespace penumbra
