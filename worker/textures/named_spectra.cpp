#include "worker/textures/named_spectra.h"

#include <cmath>

#include "worker/textures/cie.h"

namespace penumbra {
namespace {

struct Metal {
  std::string_view name;
  ComplexIndex index;
};

// Optical constants (Palik 1985) weighted with the Rec. 709 matching functions.
const Metal kMetals[] = {
    {"Ag", {{0.155265f, 0.116723f, 0.138381f}, {4.828343f, 3.122246f, 2.147050f}}},
    {"Al", {{1.657460f, 0.880369f, 0.521229f}, {9.223869f, 6.269523f, 4.837001f}}},
    {"Au", {{0.143119f, 0.374957f, 1.442479f}, {3.983160f, 2.385721f, 1.603215f}}},
    {"Cu", {{0.200438f, 0.924033f, 1.102212f}, {3.912949f, 2.452848f, 2.142188f}}},
    {"CuZn", {{0.444f, 0.527f, 1.094f}, {3.695f, 2.765f, 1.829f}}},
    {"MgO", {{2.0895885f, 1.6507223f, 1.5948759f}, {0, 0, 0}}},
    {"TiO2", {{3.2868f, 2.6246f, 2.5850f}, {0, 0, 0}}},
};

/// n² = 1 + Σ b_i λ² / (λ² - c_i), λ in µm; the makers' data sheets (Schott, Hikari).
struct Glass {
  std::string_view name;
  double b[3], c[3];
};

constexpr Glass kGlasses[] = {
    {"BK7", {1.03961212, 0.231792344, 1.01046945}, {0.00600069867, 0.0200179144, 103.560653}},
    {"BAF10", {1.5851495, 0.143559385, 1.08521269}, {0.00926681282, 0.0424489805, 105.613573}},
    {"F5", {1.3104463, 0.19603426, 0.96612977}, {0.00958633048, 0.0457627627, 115.011883}},
    {"FK51A", {0.971247817, 0.216901417, 0.904651666}, {0.00472301995, 0.0153575612, 168.68133}},
    {"LASF9", {2.00029547, 0.298926886, 1.80691843}, {0.0121426017, 0.0538736236, 156.530829}},
    {"SF5", {1.52481889, 0.187085527, 1.42729015}, {0.011254756, 0.0588995392, 129.141675}},
    {"SF10", {1.62153902, 0.256287842, 1.64447552}, {0.0122241457, 0.0595736775, 147.468793}},
    {"SF11", {1.73759695, 0.313747346, 1.89878101}, {0.013188707, 0.0623068142, 155.23629}},
};

/// CIE chromaticities (x, y) of the standard illuminants, 2° observer.
struct Illuminant {
  std::string_view name;
  double x, y;
};

constexpr Illuminant kIlluminants[] = {
    {"A", 0.44757, 0.40745},   {"D50", 0.34567, 0.35850}, {"D65", 0.31271, 0.32902}, {"F1", 0.31310, 0.33727},
    {"F2", 0.37208, 0.37529},  {"F3", 0.40910, 0.39430},  {"F4", 0.44018, 0.40329},  {"F5", 0.31379, 0.34531},
    {"F6", 0.37790, 0.38835},  {"F7", 0.31292, 0.32933},  {"F8", 0.34588, 0.35875},  {"F9", 0.37417, 0.37281},
    {"F10", 0.34609, 0.35986}, {"F11", 0.38052, 0.37713}, {"F12", 0.43695, 0.40441},
};

bool take_prefix(std::string_view& text, std::string_view prefix) {
  if (!text.starts_with(prefix)) return false;
  text.remove_prefix(prefix.size());
  return true;
}

bool take_suffix(std::string_view& text, std::string_view suffix) {
  if (!text.ends_with(suffix)) return false;
  text.remove_suffix(suffix.size());
  return true;
}

std::optional<Rgb> metal_spectrum(std::string_view name) {
  const bool eta = take_suffix(name, "-eta");
  if (!eta && !take_suffix(name, "-k")) return std::nullopt;
  for (const Metal& metal : kMetals) {
    if (metal.name == name) return eta ? metal.index.eta : metal.index.k;
  }
  return std::nullopt;
}

std::optional<Rgb> illuminant_spectrum(std::string_view name) {
  for (const Illuminant& i : kIlluminants) {
    if (i.name == name) return rgb_of_xyz({i.x / i.y, 1, (1 - i.x - i.y) / i.y});
  }
  return std::nullopt;
}

}  // namespace

ComplexIndex copper() {
  return kMetals[3].index;
}

std::optional<double> glass_index(std::string_view name, double nm) {
  if (!take_prefix(name, "glass-")) return std::nullopt;
  const double l2 = nm * nm * 1e-6;
  for (const Glass& glass : kGlasses) {
    if (glass.name != name) continue;
    double n2 = 1;
    for (int i = 0; i < 3; ++i) n2 += glass.b[i] * l2 / (l2 - glass.c[i]);
    return std::sqrt(n2);
  }
  return std::nullopt;
}

std::optional<Rgb> named_spectrum(std::string_view name) {
  if (take_prefix(name, "metal-")) return metal_spectrum(name);
  if (take_prefix(name, "stdillum-")) return illuminant_spectrum(name);
  // An index is no light: one value per channel, at the channels' dominant wavelengths.
  if (const auto red = glass_index(name, 611)) {
    return Rgb(static_cast<float>(*red), static_cast<float>(*glass_index(name, 549)),
               static_cast<float>(*glass_index(name, 464)));
  }
  return std::nullopt;
}

}  // namespace penumbra
