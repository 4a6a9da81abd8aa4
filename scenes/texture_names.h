#pragma once
#include <string_view>

namespace penumbra {

/// Float and spectrum textures have separate names.
enum class TextureSpace { kFloat, kSpectrum, kEither };

/// Where a parameter of that name looks its texture up: `owner` is the plugin name of the material or
/// shape (glass "eta" is a float, metal "eta" a spectrum; a mix's "amount" is a spectrum in v3 and a float
/// in v4). Textures' own parameters follow the texture's type instead.
TextureSpace texture_space(std::string_view owner, std::string_view parameter);

}  // namespace penumbra
