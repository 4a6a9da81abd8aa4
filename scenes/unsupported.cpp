#include <algorithm>
#include <map>

#include "proto/status.h"
#include "scenes/each_shape.h"
#include "scenes/needs.h"
#include "scenes/pbrt_names.h"
#include "scenes/unsupported_media.h"
#include "scenes/unsupported_motion.h"

namespace penumbra {
namespace {

/// How often something occurs, and where first.
struct Tally {
  int count = 0;
  FileLoc first;
  void add(FileLoc loc) {
    if (count++ == 0) first = loc;
  }
};

/// pbrt integrators whose light travels further than from a light to a first rough surface.
bool asks_for_indirect_light(const Entity& integrator) {
  const std::string& type = integrator.type;
  if (type == "bdpt" || type == "mlt" || type == "sppm" || type == "lightpath" || type == "randomwalk")
    return true;
  if (type != "path" && type != "volpath" && type != "simplepath" && type != "simplevolpath") return false;
  return integrator.params.integer("maxdepth", 5) > 1;
}

void add_entities(const SceneDescription& scene, std::vector<std::string>& out) {
  const auto say = [&](const Entity& entity, std::string_view what) {
    out.push_back(fmt::format("{}: {}", scene.place(entity.loc), what));
  };
  if (support_of(PluginKind::kCamera, scene.camera.type) != Support::kRendered && !scene.camera.type.empty())
    say(scene.camera,
        fmt::format("camera '{}' is not supported: a perspective camera instead", scene.camera.type));
  if (support_of(PluginKind::kFilter, scene.filter.type) != Support::kRendered && !scene.filter.type.empty())
    say(scene.filter, fmt::format("pixel filter '{}' is not supported", scene.filter.type));
  if (asks_for_indirect_light(scene.integrator))
    say(scene.integrator,
        fmt::format("integrator '{}' asks for indirect light: only direct light and specular "
                    "chains are rendered",
                    scene.integrator.type));
  else if (support_of(PluginKind::kIntegrator, scene.integrator.type) == Support::kSubstituted)
    say(scene.integrator,
        fmt::format("integrator '{}' is not supported: direct light instead", scene.integrator.type));
}

/// Does a light that is rendered, or a shape, shine?
bool has_light(const SceneDescription& scene) {
  bool emits = std::any_of(scene.lights.begin(), scene.lights.end(), is_rendered);
  each_shape(scene, [&emits](const ShapeEntity& shape) {
    emits |= shape.area_light >= 0 && support_of(PluginKind::kShape, shape.type) != Support::kSubstituted;
  });
  return emits;
}

void add_left_out(const SceneDescription& scene, std::vector<std::string>& out) {
  std::map<std::string, Tally> shapes, lights;
  each_shape(scene, [&shapes](const ShapeEntity& shape) {
    if (support_of(PluginKind::kShape, shape.type) == Support::kSubstituted)
      shapes[shape.type].add(shape.loc);
  });
  for (const LightEntity& light : scene.lights)
    if (!is_rendered(light)) lights[light.type].add(light.loc);
  for (const auto& [noun, tallies] : {std::pair("shape", &shapes), {"light", &lights}})
    for (const auto& [type, tally] : *tallies)
      out.push_back(fmt::format("{}: {} '{}' is not supported: {} left out", scene.place(tally.first), noun,
                                type, tally.count));
  if (!lights.empty() && !has_light(scene))
    out.push_back(
        fmt::format("{}: no light is left: the picture is black", scene.place(lights.begin()->second.first)));
}

/// An effect in worker/effects, or one that is to come there.
struct Effect {
  std::string_view name, instead;
  bool rendered;  ///< by a build with PENUMBRA_EFFECTS
};

constexpr Effect kEffects[] = {
    {"lens", "a pinhole instead", true},
    {"motion", "everything stands as when the shutter opens", true},
    {"media", "vacuum instead", true},
};

void add_effects(const SceneDescription& scene, std::vector<std::string>& out) {
  for (const Need& need : needs_of(scene))
    for (const Effect& effect : kEffects) {
      if (effect.name != need.effect || (effect.rendered && PENUMBRA_EFFECTS)) continue;
      out.push_back(fmt::format("{} is not rendered {}: {} ({})", effect.name,
                                effect.rendered ? "by this build" : "yet", effect.instead, need.why));
    }
}

}  // namespace

bool is_rendered(const LightEntity& light) {
  return support_of(PluginKind::kLight, light.type) != Support::kSubstituted;
}

std::vector<std::string> unsupported(const SceneDescription& description) {
  std::vector<std::string> out;
  add_entities(description, out);
  add_left_out(description, out);
  add_effects(description, out);
  if (PENUMBRA_EFFECTS) add_unsupported_media(description, out);
  if (PENUMBRA_EFFECTS) add_unsupported_motion(description, out);
  return out;
}

}  // namespace penumbra
