#pragma once
// Every plugin name of pbrt-v3 and pbrt-v4, and what this renderer makes of it.
#include <string_view>

namespace penumbra {

enum class PluginKind {
  kShape,
  kLight,
  kAreaLight,
  kMaterial,
  kTexture,
  kCamera,
  kFilm,
  kSampler,
  kFilter,
  kIntegrator,
  kAccelerator,
  kMedium,
};

enum class Support {
  kUnknown,      ///< no name of pbrt's
  kSubstituted,  ///< pbrt's; left out, or replaced by the nearest that is rendered, with a named warning
  kRendered,
};

Support support_of(PluginKind kind, std::string_view name);

/// "shape", "light source", … for messages.
std::string_view noun(PluginKind kind);

}  // namespace penumbra
