#include "scenes/needs.h"

#include <algorithm>
#include <optional>

#include "proto/status.h"
#include "scenes/each_shape.h"
#include "scenes/worn_materials.h"

namespace penumbra {
namespace {

using Scene = SceneDescription;
using Why = std::optional<std::string>;

Why lens(const Scene& scene) {
  const Entity& camera = scene.camera;
  if (camera.type == "realistic") return {};  // a pinhole stands in for it
  const double radius = camera.params.number("lensradius", 0);
  if (!(radius > 0)) return {};
  return fmt::format("lensradius {} at {}", radius, scene.place(camera.params.find("lensradius")->loc));
}

Why motion(const Scene& scene) {
  // pbrt's default shutter is open from 0 to 1.
  if (!(scene.camera.params.number("shutteropen", 0) < scene.camera.params.number("shutterclose", 1)))
    return {};
  if (scene.camera_placement.moving())
    return fmt::format("the camera moves, {}", scene.place(scene.camera.loc));
  for (const InstanceEntity& instance : scene.instances)
    if (instance.placement.moving()) return fmt::format("an instance moves, {}", scene.place(instance.loc));
  Why why;
  each_shape(scene, [&](const ShapeEntity& shape) {
    if (!why && shape.placement.moving())
      why = fmt::format("a {} moves, {}", shape.type, scene.place(shape.loc));
  });
  return why;
}

Why environment(const Scene& scene) {
  for (const LightEntity& light : scene.lights)
    if (light.type == "infinite" || light.type == "exinfinite")
      return fmt::format("infinite light at {}", scene.place(light.loc));
  return {};
}

Why curves(const Scene& scene) {
  Why why;
  each_shape(scene, [&](const ShapeEntity& shape) {
    if (!why && shape.type == "curve") why = fmt::format("curve at {}", scene.place(shape.loc));
  });
  return why;
}

Why media(const Scene& scene) {
  if (!scene.camera_medium.empty())
    return fmt::format("the camera stands in medium '{}', {}", scene.camera_medium,
                       scene.place(scene.camera.loc));
  Why why;
  each_shape(scene, [&](const ShapeEntity& shape) {
    const std::string& medium = shape.inside_medium.empty() ? shape.outside_medium : shape.inside_medium;
    if (!why && !medium.empty())
      why = fmt::format("medium '{}' at a {}, {}", medium, shape.type, scene.place(shape.loc));
  });
  return why;
}

const Param* textured(const Params& params) {
  const auto found = std::find_if(params.all.begin(), params.all.end(),
                                  [](const Param& param) { return param.texture >= 0; });
  return found != params.all.end() ? &*found : nullptr;
}

Why textures(const Scene& scene) {
  const auto because = [&scene](const Param& param) {
    return fmt::format("texture '{}' at {}", param.strings[0], scene.place(param.loc));
  };
  for (const MaterialEntity* material : worn_materials(scene))
    if (const Param* const param = textured(material->params)) return because(*param);
  Why why;
  each_shape(scene, [&](const ShapeEntity& shape) {
    const Param* const param = why ? nullptr : textured(shape.params);
    if (param) why = because(*param);
  });
  return why;
}

Why alpha(const Scene& scene) {
  Why why;
  each_shape(scene, [&](const ShapeEntity& shape) {
    for (const char* const name : {"alpha", "shadowalpha"}) {
      const Param* const param = why ? nullptr : shape.params.find(name);
      if (!param) continue;
      if (param->texture >= 0 || (!param->numbers.empty() && param->numbers[0] < 1))
        why = fmt::format("{} at {}", name, scene.place(param->loc));
    }
  });
  return why;
}

Why bump(const Scene& scene) {
  for (const MaterialEntity* material : worn_materials(scene))
    for (const char* const name : {"bumpmap", "displacement", "normalmap"})
      if (const Param* const param = material->params.find(name))
        return fmt::format("{} at {}", name, scene.place(param->loc));
  return {};
}

/// Any component of a colour parameter (or of the texture behind it) that may differ from `value`.
bool may_differ(const Params& params, std::string_view name, double value) {
  const Param* const param = params.find(name);
  if (!param) return false;
  if (param->texture >= 0 || param->numbers.empty()) return true;
  return std::any_of(param->numbers.begin(), param->numbers.end(), [value](double x) { return x != value; });
}

bool is_rough(const Params& params, double fallback) {
  if (params.find("roughness") && may_differ(params, "roughness", 0)) return true;
  const bool given = params.find("uroughness") || params.find("vroughness") || params.find("roughness");
  if (!given) return fallback > 0;
  return may_differ(params, "uroughness", 0) && may_differ(params, "vroughness", 0);
}

Why specular(const Scene& scene) {
  for (const MaterialEntity* material : worn_materials(scene))
    if (is_specular(*material)) return fmt::format("{} at {}", material->type, scene.place(material->loc));
  return {};
}

struct Effect {
  const char* name;
  Why (*why)(const Scene&);
};

constexpr Effect kEffects[] = {
    {"lens", lens},     {"motion", motion}, {"environment", environment},
    {"curves", curves}, {"media", media},   {"textures", textures},
    {"alpha", alpha},   {"bump", bump},     {"specular", specular},
};

}  // namespace

bool is_specular(const MaterialEntity& material) {
  const Params& params = material.params;
  if (material.type == "mirror" || material.type == "thindielectric") return true;
  if (material.type == "glass" || material.type == "dielectric" || material.type == "conductor")
    return !is_rough(params, 0);
  if (material.type == "metal") return !is_rough(params, 0.01);
  if (material.type == "uber")
    return may_differ(params, "Kr", 0) || may_differ(params, "Kt", 0) || may_differ(params, "opacity", 1);
  return false;
}

std::vector<Need> needs_of(const SceneDescription& description) {
  std::vector<Need> needs;
  for (const Effect& effect : kEffects)
    if (Why why = effect.why(description)) needs.push_back({effect.name, *std::move(why)});
  return needs;
}

}  // namespace penumbra
