#pragma once
#include <string>
#include <vector>

#include "scenes/description.h"

namespace penumbra {

/// What the media that some shape or the camera names ask for and do not get, one warning each.
void add_unsupported_media(const SceneDescription& scene, std::vector<std::string>& out);

}  // namespace penumbra
