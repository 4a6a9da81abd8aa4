#pragma once
// Part of unsupported(): what moves in a scene and is rendered standing still.
#include <string>
#include <vector>

#include "scenes/description.h"

namespace penumbra {

/// Appends `place: …`, one line per kind.
void add_unsupported_motion(const SceneDescription& scene, std::vector<std::string>& out);

}  // namespace penumbra
