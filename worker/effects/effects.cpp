#include "worker/effects/effects.h"

#include "worker/render/camera_stage.h"

namespace penumbra {

absl::StatusOr<Effects> build_effects(const SceneDescription&) {
  return Effects();
}

}  // namespace penumbra
