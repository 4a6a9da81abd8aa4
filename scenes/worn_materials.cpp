#include "scenes/worn_materials.h"

#include <string>
#include <unordered_map>

#include "scenes/each_shape.h"

namespace penumbra {
namespace {

/// Names that a mix refers to: v3's namedmaterial1/2, v4's materials.
std::vector<std::string> parts_of(const MaterialEntity& material) {
  std::vector<std::string> names;
  for (const char* const key : {"namedmaterial1", "namedmaterial2", "materials"}) {
    const Param* const param = material.params.find(key);
    if (param) names.insert(names.end(), param->strings.begin(), param->strings.end());
  }
  return names;
}

}  // namespace

std::vector<const MaterialEntity*> worn_materials(const SceneDescription& description) {
  const std::vector<MaterialEntity>& materials = description.materials;
  std::unordered_map<std::string, int> named;
  for (size_t i = 0; i < materials.size(); ++i)
    if (!materials[i].name.empty()) named[materials[i].name] = static_cast<int>(i);

  std::vector<bool> worn(materials.size(), false);
  std::vector<int> pending;
  each_shape(description, [&pending](const ShapeEntity& shape) {
    if (shape.material >= 0) pending.push_back(shape.material);
  });
  while (!pending.empty()) {
    const int index = pending.back();
    pending.pop_back();
    if (worn[index]) continue;  // also ends mixes that name one another
    worn[index] = true;
    if (materials[index].type != "mix") continue;
    for (const std::string& name : parts_of(materials[index]))
      if (const auto part = named.find(name); part != named.end()) pending.push_back(part->second);
  }

  std::vector<const MaterialEntity*> out;
  for (size_t i = 0; i < materials.size(); ++i)
    if (worn[i]) out.push_back(&materials[i]);
  return out;
}

}  // namespace penumbra
