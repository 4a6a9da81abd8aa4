#pragma once
#include "scenes/description.h"

namespace penumbra {

/// Calls visit(owner, params) for the parameters of every material, texture, light and shape. The owner
/// is the plugin name; for textures "float texture" or "spectrum texture".
template <class Description, class Visit>
void each_params(Description& description, Visit&& visit) {
  static const std::string kFloat = "float texture", kSpectrum = "spectrum texture";
  for (auto& texture : description.textures) visit(texture.is_float ? kFloat : kSpectrum, texture.params);
  for (auto& material : description.materials) visit(material.type, material.params);
  for (auto& light : description.lights) visit(light.type, light.params);
  for (auto& light : description.area_lights) visit(light.type, light.params);
  for (auto& shape : description.shapes) visit(shape.type, shape.params);
  for (auto& object : description.objects)
    for (auto& shape : object.shapes) visit(shape.type, shape.params);
}

}  // namespace penumbra
