#include "scenes/leave_out.h"

#include <algorithm>
#include <initializer_list>

#include "proto/status.h"
#include "scenes/needs.h"
#include "scenes/standing.h"

namespace penumbra {
namespace {

using Scene = SceneDescription;

template <class Change>
void change_shapes(Scene& scene, Change change) {
  change(scene.shapes);
  for (ObjectEntity& object : scene.objects) change(object.shapes);
}

template <class Change>
void change_each_shape(Scene& scene, Change change) {
  change_shapes(
      scene, [&](std::vector<ShapeEntity>& shapes) { std::for_each(shapes.begin(), shapes.end(), change); });
}

bool named(const Param& param, std::initializer_list<std::string_view> names) {
  return std::find(names.begin(), names.end(), param.name) != names.end();
}

bool is_alpha(const Param& param) {
  return named(param, {"alpha", "shadowalpha"});
}
bool is_bump(const Param& param) {
  return named(param, {"bumpmap", "displacement", "normalmap"});
}

void lens(Scene& scene) {
  std::erase_if(scene.camera.params.all, [](const Param& p) { return p.name == "lensradius"; });
}

void environment(Scene& scene) {
  std::erase_if(scene.lights,
                [](const LightEntity& l) { return l.type == "infinite" || l.type == "exinfinite"; });
}

void curves(Scene& scene) {
  change_shapes(scene, [](std::vector<ShapeEntity>& shapes) {
    std::erase_if(shapes, [](const ShapeEntity& shape) { return shape.type == "curve"; });
  });
}

void media(Scene& scene) {
  scene.camera_medium.clear();
  change_each_shape(scene, [](ShapeEntity& shape) {
    shape.inside_medium.clear();
    shape.outside_medium.clear();
  });
}

void textures(Scene& scene) {
  const auto strip = [](Params& params) {
    std::erase_if(params.all, [](const Param& p) { return p.texture >= 0; });
  };
  for (MaterialEntity& material : scene.materials) strip(material.params);
  change_each_shape(scene, [&](ShapeEntity& shape) { strip(shape.params); });
}

void alpha(Scene& scene) {
  change_each_shape(scene, [](ShapeEntity& shape) { std::erase_if(shape.params.all, is_alpha); });
}

void bump(Scene& scene) {
  for (MaterialEntity& material : scene.materials) std::erase_if(material.params.all, is_bump);
}

void specular(Scene& scene) {
  for (MaterialEntity& material : scene.materials) {
    if (!is_specular(material)) continue;
    material.type = "matte";
    // What is no matte parameter would be named in vain.
    std::erase_if(material.params.all, [](const Param& p) { return !is_bump(p); });
  }
}

struct Effect {
  std::string_view name;
  void (*leave_out)(Scene&);
};

constexpr Effect kEffects[] = {
    {"lens", lens},   {"environment", environment}, {"curves", curves},
    {"media", media}, {"textures", textures},       {"alpha", alpha},
    {"bump", bump},   {"specular", specular},
};

}  // namespace

absl::Status leave_out(std::string_view name, SceneDescription& description) {
  if (name == "motion") {
    ASSIGN_OR_RETURN(description, standing(description, false));
    return absl::OkStatus();
  }
  for (const Effect& effect : kEffects) {
    if (effect.name != name) continue;
    effect.leave_out(description);
    return absl::OkStatus();
  }
  return invalid_input("leave_out: no effect of a scene is called '{}'", name);
}

}  // namespace penumbra
