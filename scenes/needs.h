#pragma once
// Which effects a scene calls for (design §8), read once from its description.
#include <string>
#include <vector>

#include "proto/job.h"
#include "scenes/description.h"

namespace penumbra {

/// Effects named lens, motion, environment, curves, media, textures, alpha, bump, specular, in this order,
/// each with the first place that calls for it. (Transient transport is asked for by the job, not by the
/// scene.) Materials count where a shape wears them.
std::vector<Need> needs_of(const SceneDescription& description);

/// Whether the material may have a specular lobe: what calls for the effect `specular`.
bool is_specular(const MaterialEntity& material);

/// Of pbrt's lights some are left out (goniometric, projection).
bool is_rendered(const LightEntity& light);

/// `place: …` for everything that is read but not rendered, one line per kind: shapes and lights that are
/// left out, cameras and integrators that something simpler stands in for, effects to come. Materials and
/// textures are not among them: who substitutes them says so.
std::vector<std::string> unsupported(const SceneDescription& description);

}  // namespace penumbra
