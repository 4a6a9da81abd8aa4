#pragma once
// A scene without one of the effects that it calls for: what the effect costs is measured against that.
#include <string>
#include <string_view>

#include "absl/status/status.h"
#include "scenes/description.h"

namespace penumbra {

/// Takes an effect (named as in needs.h) out of the description: the lens becomes a pinhole, what moves
/// stands as when the shutter opens, infinite lights and curves go, media become vacuum, what is textured
/// (alpha and bumps, too) takes its default, alpha and bumps go, specular materials become matte. Afterwards
/// needs_of() does not name it. InvalidArgument: no effect of that name,
/// or a motion that cannot be (scenes/standing.h).
absl::Status leave_out(std::string_view effect, SceneDescription& description);

}  // namespace penumbra
