#pragma once
// The effects that a scene calls for, chosen once at load from its needs (design §8). Each is a stage that
// the room which uses it declares; null: not called for, or not part of this build (CMake's
// PENUMBRA_EFFECTS).
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "scenes/description.h"
#include "scenes/files.h"

namespace penumbra {

class CameraStage;
class MediumStage;

struct Effects {
  std::shared_ptr<const CameraStage> camera;  ///< worker/render/camera_stage.h
  bool lens = false;                          ///< the camera stage has one
  bool motion = false;                        ///< shapes and instances move, as scenes/standing.h says
  std::shared_ptr<const MediumStage> media;   ///< worker/render/medium_stage.h
};

/// Builds what the description calls for and nothing else. What it calls for in vain is named by
/// unsupported(). InvalidArgument: a parameter out of range.
absl::StatusOr<Effects> build_effects(const SceneDescription& description);

/// The media, when the scene's meshes are known: `shapes` are what they were made from, one per mesh.
absl::StatusOr<std::shared_ptr<const MediumStage>> build_media(const SceneDescription& description,
                                                               const SceneFiles& files,
                                                               std::span<const ShapeEntity* const> shapes,
                                                               int threads);

}  // namespace penumbra
