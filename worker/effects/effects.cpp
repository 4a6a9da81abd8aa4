#include "worker/effects/effects.h"

#include <algorithm>

#include "proto/status.h"
#include "scenes/needs.h"
#include "worker/effects/lens.h"

namespace penumbra {

absl::StatusOr<Effects> build_effects(const SceneDescription& description) {
  const std::vector<Need> needs = needs_of(description);
  const auto needed = [&](const char* effect) {
    return std::any_of(needs.begin(), needs.end(), [&](const Need& need) { return need.effect == effect; });
  };
  Effects effects;
  // A realistic camera calls for a lens too, but what stands in for it is a pinhole.
  if (needed("lens") && description.camera.params.number("lensradius", 0) > 0) {
    ASSIGN_OR_RETURN(Lens lens, Lens::build(description));
    effects.camera = std::make_shared<const Lens>(std::move(lens));
  }
  return effects;
}

}  // namespace penumbra
