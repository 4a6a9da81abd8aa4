// pbrt's `hair`, v3's names and v4's.
#include <limits>

#include "proto/status.h"
#include "worker/materials/material_builder.h"

namespace penumbra {

/// As in pbrt, absorption goes before a colour, a colour before melanin; none at all is brown hair.
MaterialBuilder::Built MaterialBuilder::hair(const MaterialEntity& entity) {
  constexpr float kUnbounded = std::numeric_limits<float>::max();
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
  ASSIGN_OR_RETURN(m.eumelanin, number(entity, "eumelanin", brown, 0, kUnbounded));
  ASSIGN_OR_RETURN(m.pheomelanin, number(entity, "pheomelanin", 0, 0, kUnbounded));
  ASSIGN_OR_RETURN(m.eta, number(entity, "eta", 1.55f, 1, kUnbounded));
  ASSIGN_OR_RETURN(m.beta_m, number(entity, "beta_m", 0.3f, 0, 1));
  ASSIGN_OR_RETURN(m.beta_n, number(entity, "beta_n", 0.3f, 0, 1));
  ASSIGN_OR_RETURN(m.alpha, number(entity, "alpha", 2, -90, 90));
  return m;
}

}  // namespace penumbra
