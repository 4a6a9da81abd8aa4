#pragma once
#include <vector>

#include "scenes/description.h"

namespace penumbra {

/// The materials that some shape wears, those that a mix names included; each once, in the order of the
/// text.
std::vector<const MaterialEntity*> worn_materials(const SceneDescription& description);

}  // namespace penumbra
