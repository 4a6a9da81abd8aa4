#pragma once
// What stands in for things that a scene asks for and does not get: materials that are not rendered, images
// that are not there. Told by a render when it builds them, and by `inspect` from the text and the folder
// alone.
#include <string>
#include <string_view>
#include <vector>

#include "scenes/description.h"
#include "scenes/files.h"

namespace penumbra {

/// The kind of material that stands in for one of pbrt's that is not rendered; empty: nothing does.
std::string_view substitute_of(std::string_view material_type);

/// `place: material 'disney' is not supported: substrate instead`.
std::string substitution_text(const MaterialEntity& material, const SceneDescription& description);
/// The same of an image, `why` it cannot be read.
std::string missing_text(const TextureEntity& texture, std::string_view why,
                         const SceneDescription& description);
std::string missing_text(const LightEntity& light, std::string_view map, const SceneDescription& description);
std::string missing_normal_map_text(const Param& param, std::string_view why,
                                    const SceneDescription& description);

/// All of these that a render will say, of what shapes wear and lights shine: images whose files are not
/// there, but not those that are there and cannot be read.
std::vector<std::string> substitutes(const SceneDescription& description, const SceneFiles& files);

}  // namespace penumbra
