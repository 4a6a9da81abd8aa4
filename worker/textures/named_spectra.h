#pragma once
// The spectra that pbrt knows by name: "metal-Cu-eta", "glass-BK7", "stdillum-D65", …
#include <optional>
#include <string_view>

#include "scenes/math.h"

namespace penumbra {

/// Linear RGB of a named spectrum; empty if there is none of that name.
std::optional<Rgb> named_spectrum(std::string_view name);

/// Copper, pbrt's default metal.
struct ComplexIndex {
  Rgb eta, k;
};
ComplexIndex copper();

/// Index of refraction of a glass of that name ("glass-BK7") at a wavelength in nm, by its Sellmeier formula.
std::optional<double> glass_index(std::string_view name, double nm);

}  // namespace penumbra
