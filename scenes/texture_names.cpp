#include "scenes/texture_names.h"

#include <algorithm>
#include <iterator>

namespace penumbra {
namespace {

// pbrt-v3's and v4's parameters that are looked up among the float textures, whatever the plugin.
constexpr std::string_view kFloatParameters[] = {"alpha",
                                                 "shadowalpha",
                                                 "bumpmap",
                                                 "displacement",
                                                 "sigma",
                                                 "roughness",
                                                 "uroughness",
                                                 "vroughness",
                                                 "index",
                                                 "interface.roughness",
                                                 "interface.uroughness",
                                                 "interface.vroughness",
                                                 "conductor.roughness",
                                                 "conductor.uroughness",
                                                 "conductor.vroughness",
                                                 "thickness",
                                                 "g",
                                                 "metallic",
                                                 "speculartint",
                                                 "anisotropic",
                                                 "sheen",
                                                 "sheentint",
                                                 "clearcoat",
                                                 "clearcoatgloss",
                                                 "spectrans",
                                                 "flatness",
                                                 "difftrans",
                                                 "eumelanin",
                                                 "pheomelanin",
                                                 "beta_m",
                                                 "beta_n"};

}  // namespace

TextureSpace texture_space(std::string_view owner, std::string_view parameter) {
  if (parameter == "amount") return TextureSpace::kEither;
  if (parameter == "eta")
    return owner == "metal" || owner == "conductor" ? TextureSpace::kSpectrum : TextureSpace::kFloat;
  const bool is_float = std::find(std::begin(kFloatParameters), std::end(kFloatParameters), parameter) !=
                        std::end(kFloatParameters);
  return is_float ? TextureSpace::kFloat : TextureSpace::kSpectrum;
}

}  // namespace penumbra
