#pragma once
// The effects that a scene calls for, chosen once at load from its needs (design §8). Each is a stage that
// the room which uses it declares; null: not called for, or not part of this build (CMake's
// PENUMBRA_EFFECTS).
#include <memory>

#include "absl/status/statusor.h"
#include "scenes/description.h"

namespace penumbra {

class CameraStage;

struct Effects {
  std::shared_ptr<const CameraStage> camera;  ///< worker/render/camera_stage.h
};

/// Builds what the description calls for and nothing else. What it calls for in vain is named by
/// unsupported(). InvalidArgument: a parameter out of range.
absl::StatusOr<Effects> build_effects(const SceneDescription& description);

}  // namespace penumbra
