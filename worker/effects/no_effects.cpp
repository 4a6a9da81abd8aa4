// The registry of a build without effects (CMake's PENUMBRA_EFFECTS=OFF): what bench_needs compares with.
#include "worker/effects/effects.h"

namespace penumbra {

absl::StatusOr<Effects> build_effects(const SceneDescription&) {
  return Effects();
}

absl::StatusOr<std::shared_ptr<const MediumStage>> build_media(const SceneDescription&, const SceneFiles&,
                                                               std::span<const ShapeEntity* const>, int) {
  return nullptr;
}

}  // namespace penumbra
