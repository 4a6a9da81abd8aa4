#pragma once
// Where the renderer puts the origin. Everything is computed in single precision from world coordinates, so a
// small scene far from the origin would lose its digits (millimetres, 1e6 m away: steps of 64 mm). Such a
// scene is moved to its camera, in double precision, before anything is rounded.
#include <optional>

#include "absl/status/statusor.h"
#include "scenes/description.h"
#include "scenes/files.h"

namespace penumbra {

/// The point that becomes the origin: near the camera, if camera and shapes are all far from the origin
/// compared with how far they are from each other; otherwise none.
absl::StatusOr<std::optional<Vec3d>> distant_origin(const SceneDescription& description,
                                                    const SceneFiles& files);

/// The same scene with `origin` at (0,0,0): camera, shapes, instances, lights, media, and textures that are
/// defined in the world. Pictures are the same but for rounding.
SceneDescription moved_to(const Vec3d& origin, const SceneDescription& description);

}  // namespace penumbra
