#pragma once
// What of a scene's motion is rendered, and how the rest stands.
#include "absl/status/statusor.h"
#include "scenes/description.h"

namespace penumbra {

/// Does the camera, a shape or an instance have two placements?
bool anything_moves(const SceneDescription& description);

/// Can its motion be rendered? Not that of boundaries of media or of curves that are tubes (nor of instances
/// of such), nor within an object. What emits goes on to emit (in pbrt it does not).
bool can_move(const ShapeEntity& shape);
bool can_move(const InstanceEntity& instance, const SceneDescription& description);

/// The scene as it stands when the shutter opens, its placements' ends like their starts; with `movers`,
/// shapes of the world and instances that can move keep theirs. Lights, textures and media stand at their
/// first transform, as in pbrt. InvalidArgument: a motion from a placement that mirrors to one that does not.
absl::StatusOr<SceneDescription> standing(const SceneDescription& description, bool movers);

}  // namespace penumbra
