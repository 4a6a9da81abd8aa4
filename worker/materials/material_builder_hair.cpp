// pbrt's `hair`, v3's names and v4's.
#include <algorithm>

#include "proto/status.h"
#include "scenes/hair_params.h"
#include "worker/materials/material_builder.h"

namespace penumbra {

/// As in pbrt, absorption goes before a colour, a colour before melanin; none at all is brown hair.
MaterialBuilder::Built MaterialBuilder::hair(const MaterialEntity& entity) {
  const auto given = [&](std::string_view name) { return entity.params.find(name) != nullptr; };
  const char* const color_name = given("reflectance") ? "reflectance" : "color";
  HairMaterial m{.tint = {Rgb(0)}};
  if (given("sigma_a")) {
    m.pigment = HairMaterial::Pigment::kAbsorption;
    ASSIGN_OR_RETURN(m.tint, color(entity, "sigma_a", Rgb(0)));
  } else if (given(color_name)) {
    m.pigment = HairMaterial::Pigment::kColor;
    ASSIGN_OR_RETURN(m.tint, color(entity, color_name, Rgb(0)));
  }
  for (const char* const name : {color_name, "eumelanin", "pheomelanin"}) {
    const bool loses = m.pigment == HairMaterial::Pigment::kAbsorption ||
                       (m.pigment == HairMaterial::Pigment::kColor && name != color_name);
    if (loses && given(name))
      warnings_.push_back(fmt::format("{}: hair has {} already: {} is left out",
                                      description_.place(entity.params.find(name)->loc),
                                      given("sigma_a") ? "sigma_a" : color_name, name));
  }
  const float brown = given("eumelanin") || given("pheomelanin") ? 0 : 1.3f;
  const auto read = [&](std::string_view name, float fallback) {
    const auto known = hair_numbers();
    const auto range =
        std::find_if(known.begin(), known.end(), [&](const HairNumber& n) { return n.name == name; });
    PENUMBRA_CHECK(range != known.end());
    return number(entity, name, fallback, range->least, range->most);
  };
  ASSIGN_OR_RETURN(m.eumelanin, read("eumelanin", brown));
  ASSIGN_OR_RETURN(m.pheomelanin, read("pheomelanin", 0));
  ASSIGN_OR_RETURN(m.eta, read("eta", 1.55f));
  ASSIGN_OR_RETURN(m.beta_m, read("beta_m", 0.3f));
  ASSIGN_OR_RETURN(m.beta_n, read("beta_n", 0.3f));
  ASSIGN_OR_RETURN(m.alpha, read("alpha", 2));
  return m;
}

}  // namespace penumbra
