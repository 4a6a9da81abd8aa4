#include "scenes/substitutes.h"

#include <algorithm>
#include <iterator>

#include "proto/status.h"
#include "scenes/each_shape.h"
#include "scenes/needs.h"
#include "scenes/worn_materials.h"

namespace penumbra {
namespace {

struct Substitute {
  std::string_view material, instead;
};
// fourier, measured: tables; the last ones are pbrt-v1's own names.
constexpr Substitute kSubstitutes[] = {
    {"disney", "substrate"}, {"kdsubsurface", "matte"}, {"subsurface", "matte"}, {"fourier", "matte"},
    {"measured", "matte"},   {"debug", "matte"},        {"bluepaint", "matte"},  {"brushedmetal", "matte"},
    {"clay", "matte"},       {"felt", "matte"},         {"primer", "matte"},     {"shinymetal", "matte"},
    {"skin", "matte"}};

/// Marks the textures that parameters name.
void mark(const Params& params, std::vector<bool>& used) {
  for (const Param& param : params.all)
    if (param.type == "texture" && param.texture >= 0) used[static_cast<size_t>(param.texture)] = true;
}

/// Textures that something worn names, and those that these name: a texture names earlier ones only.
std::vector<bool> used_textures(const SceneDescription& description) {
  std::vector<bool> used(description.textures.size(), false);
  for (const MaterialEntity* material : worn_materials(description)) mark(material->params, used);
  each_shape(description, [&](const ShapeEntity& shape) { mark(shape.params, used); });
  for (size_t i = used.size(); i-- > 0;)
    if (used[i]) mark(description.textures[i].params, used);
  return used;
}

}  // namespace

std::string_view substitute_of(std::string_view material_type) {
  const auto* found = std::find_if(std::begin(kSubstitutes), std::end(kSubstitutes),
                                   [&](const Substitute& s) { return s.material == material_type; });
  return found != std::end(kSubstitutes) ? found->instead : std::string_view();
}

std::string substitution_text(const MaterialEntity& material, const SceneDescription& description) {
  return fmt::format("{}: material '{}' is not supported: {} instead", description.place(material.loc),
                     material.type, substitute_of(material.type));
}

std::string missing_text(const TextureEntity& texture, std::string_view why,
                         const SceneDescription& description) {
  return fmt::format("{}: image '{}' of texture '{}' cannot be read ({}): constant 1 instead",
                     description.place(texture.loc), texture.params.string("filename", ""), texture.name,
                     why);
}

std::string missing_text(const LightEntity& light, std::string_view map,
                         const SceneDescription& description) {
  return fmt::format("{}: environment map '{}' is missing; constant 1 instead", description.place(light.loc),
                     map);
}

std::string missing_normal_map_text(const Param& param, std::string_view why,
                                    const SceneDescription& description) {
  return fmt::format("{}: normal map '{}' cannot be read ({}): none instead", description.place(param.loc),
                     param.strings.empty() ? "" : param.strings[0], why);
}

std::vector<std::string> substitutes(const SceneDescription& description, const SceneFiles& files) {
  std::vector<std::string> out;
  for (const MaterialEntity* material : worn_materials(description)) {
    if (!substitute_of(material->type).empty()) out.push_back(substitution_text(*material, description));
    const Param* const map = material->params.find("normalmap");
    if (map == nullptr || map->strings.empty() || map->strings[0].empty()) continue;
    if (const auto path = files.path_of(map->strings[0]); !path.ok())
      out.push_back(missing_normal_map_text(*map, message_of(path.status()), description));
  }
  const std::vector<bool> used = used_textures(description);
  for (size_t i = 0; i < used.size(); ++i) {
    const TextureEntity& texture = description.textures[i];
    if (!used[i] || texture.type != "imagemap") continue;
    if (const auto path = files.path_of(texture.params.string("filename", "")); !path.ok())
      out.push_back(missing_text(texture, message_of(path.status()), description));
  }
  for (const LightEntity& light : description.lights) {
    if (light.type != "infinite" && light.type != "exinfinite") continue;
    const std::string map =
        light.params.string(light.params.find("filename") != nullptr ? "filename" : "mapname", "");
    if (!map.empty() && !files.path_of(map).ok()) out.push_back(missing_text(light, map, description));
  }
  return out;
}

}  // namespace penumbra
