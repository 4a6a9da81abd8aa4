// pbrt-v4's materials, and those of any version that are replaced by their nearest.
#include <algorithm>

#include "proto/status.h"
#include "scenes/substitutes.h"
#include "worker/materials/material_builder.h"
#include "worker/textures/named_spectra.h"

namespace penumbra {

MaterialBuilder::Built MaterialBuilder::build_v4(const MaterialEntity& entity) {
  const std::string& type = entity.type;
  if (type == "diffuse") return matte(entity, "reflectance", 0.5f);
  if (type == "conductor") return conductor(entity, "");
  if (type == "dielectric") return dielectric(entity);
  if (type == "diffusetransmission") return diffuse_transmission(entity);
  if (type == "thindielectric") {
    ASSIGN_OR_RETURN(const FloatValue eta, index_of_refraction(entity, "eta"));
    return ThinGlassMaterial{eta};
  }
  if (type == "coatedconductor") {
    RETURN_IF_ERROR(
        complain(entity.loc, "material 'coatedconductor': rendered as its conductor without the coat"));
    return conductor(entity, "conductor.");
  }
  RETURN_IF_ERROR(complain(entity.loc,
                           "material 'coateddiffuse': the layers' random walk is replaced by a coat over a "
                           "Lambertian base in closed form (exact for a smooth coat without a medium)"));
  return coated_diffuse(entity);
}

MaterialBuilder::Built MaterialBuilder::conductor(const MaterialEntity& entity, std::string_view prefix) {
  ASSIGN_OR_RETURN(const Roughness rough, roughness(entity, 0, Remap::kV4, Smooth::kLeastAlpha, prefix));
  const std::string eta_name = std::string(prefix) + "eta", k_name = std::string(prefix) + "k";
  if (entity.params.find("reflectance") != nullptr) {
    ASSIGN_OR_RETURN(const RgbValue reflectance, color(entity, "reflectance", Rgb(1)));
    return ReflectanceMetalMaterial{reflectance, rough};
  }
  ASSIGN_OR_RETURN(const RgbValue eta, color(entity, eta_name, copper().eta));
  ASSIGN_OR_RETURN(const RgbValue k, color(entity, k_name, copper().k));
  return MetalMaterial{eta, k, rough};
}

MaterialBuilder::Built MaterialBuilder::dielectric(const MaterialEntity& entity) {
  ASSIGN_OR_RETURN(const FloatValue eta, index_of_refraction(entity, "eta"));
  ASSIGN_OR_RETURN(const Roughness rough, roughness(entity, 0, Remap::kV4, Smooth::kLeastAlpha));
  return GlassMaterial{{Rgb(1)}, {Rgb(1)}, eta, rough};
}

MaterialBuilder::Built MaterialBuilder::coated_diffuse(const MaterialEntity& entity) {
  ASSIGN_OR_RETURN(const RgbValue reflectance, color(entity, "reflectance", Rgb(0.5f)));
  ASSIGN_OR_RETURN(const FloatValue eta, index_of_refraction(entity, "eta"));
  if (eta.texture < 0 && !(eta.constant > 1)) {
    return invalid_input("{}: a coat's eta must be above 1, not {}", description_.place(entity.loc),
                         eta.constant);
  }
  ASSIGN_OR_RETURN(const Roughness rough, roughness(entity, 0, Remap::kV4, Smooth::kLeastAlpha));
  return CoatedDiffuseMaterial{reflectance, eta, rough};
}

MaterialBuilder::Built MaterialBuilder::diffuse_transmission(const MaterialEntity& entity) {
  ASSIGN_OR_RETURN(RgbValue reflect, color(entity, "reflectance", Rgb(0.25f)));
  ASSIGN_OR_RETURN(RgbValue transmit, color(entity, "transmittance", Rgb(0.25f)));
  ASSIGN_OR_RETURN(const FloatValue scale, number(entity, "scale", 1, 0, std::numeric_limits<float>::max()));
  return TranslucentMaterial{{Rgb(scale.constant)}, {Rgb(0)}, reflect, transmit, {}};
}

MaterialBuilder::Built MaterialBuilder::build_nearest(const MaterialEntity& entity) {
  const std::string& type = entity.type;
  const std::string_view substitute = substitute_of(type);
  if (substitute.empty())
    return invalid_input("{}: unknown material '{}'", description_.place(entity.loc), type);
  RETURN_IF_ERROR(complain(substitution_text(entity, description_)));
  if (substitute == "substrate") {  // disney
    ASSIGN_OR_RETURN(const RgbValue kd, color(entity, "color", Rgb(0.5f)));
    ASSIGN_OR_RETURN(const Roughness rough, roughness(entity, 0.5f, Remap::kV4, Smooth::kNever));
    return SubstrateMaterial{kd, {Rgb(0.04f)}, rough};
  }
  return matte(entity, type == "subsurface" ? "reflectance" : "Kd", 0.5f);
}

}  // namespace penumbra
