#include "worker/effects/effects.h"

#include <algorithm>

#include "proto/status.h"
#include "scenes/needs.h"
#include "scenes/standing.h"
#include "worker/effects/lens.h"
#include "worker/effects/motion.h"

namespace penumbra {
namespace {

/// The camera alone, as it stands when the shutter opens.
absl::StatusOr<SceneDescription> camera_standing(const SceneDescription& description) {
  SceneDescription camera;
  camera.files = description.files;
  camera.camera = description.camera;
  camera.camera_placement = description.camera_placement;
  camera.transform_start_time = description.transform_start_time;
  camera.transform_end_time = description.transform_end_time;
  return standing(camera, false);
}

}  // namespace

absl::StatusOr<Effects> build_effects(const SceneDescription& description) {
  const std::vector<Need> needs = needs_of(description);
  const auto needed = [&](const char* effect) {
    return std::any_of(needs.begin(), needs.end(), [&](const Need& need) { return need.effect == effect; });
  };
  Effects effects;
  if (needed("lens")) {
    ASSIGN_OR_RETURN(const SceneDescription still, camera_standing(description));
    ASSIGN_OR_RETURN(Lens lens, Lens::build(still));
    effects.camera = std::make_shared<const Lens>(std::move(lens));
    effects.lens = true;
  }
  if (needed("motion")) {
    ASSIGN_OR_RETURN(Motion motion, Motion::build(description, effects.camera));
    effects.camera = std::make_shared<const Motion>(std::move(motion));
    effects.motion = true;
  }
  return effects;
}

}  // namespace penumbra
