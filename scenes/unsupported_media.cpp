#include "scenes/unsupported_media.h"

#include <map>

#include "proto/status.h"
#include "scenes/each_shape.h"

namespace penumbra {
namespace {

/// Media that are named somewhere, each with the first place.
std::map<std::string, FileLoc> named_media(const SceneDescription& scene) {
  std::map<std::string, FileLoc> named;
  const auto add = [&named](const std::string& name, FileLoc loc) {
    if (!name.empty()) named.emplace(name, loc);
  };
  add(scene.camera_medium, scene.camera.loc);
  each_shape(scene, [&](const ShapeEntity& shape) {
    add(shape.inside_medium, shape.loc);
    add(shape.outside_medium, shape.loc);
  });
  return named;
}

const MediumEntity* last_of_name(const SceneDescription& scene, const std::string& name) {
  for (auto medium = scene.media.rbegin(); medium != scene.media.rend(); ++medium)
    if (medium->name == name) return &*medium;
  return nullptr;
}

}  // namespace

void add_unsupported_media(const SceneDescription& scene, std::vector<std::string>& out) {
  for (const auto& [name, loc] : named_media(scene)) {
    const MediumEntity* medium = last_of_name(scene, name);
    if (medium == nullptr) {
      out.push_back(fmt::format("{}: there is no medium '{}': vacuum instead", scene.place(loc), name));
      continue;
    }
    const std::string at = scene.place(medium->loc);
    if (medium->type != "homogeneous" && medium->type != "heterogeneous" && medium->type != "uniformgrid") {
      out.push_back(fmt::format("{}: medium '{}' of type '{}' is not supported: vacuum instead", at, name,
                                medium->type));
      continue;
    }
    if (const std::string preset = medium->params.string("preset", ""); !preset.empty())
      out.push_back(fmt::format(
          "{}: medium '{}': preset '{}' is not known: sigma_a and sigma_s as without it", at, name, preset));
    for (const char* emission : {"Le", "temperature"})
      if (medium->params.find(emission) != nullptr)
        out.push_back(fmt::format("{}: medium '{}': emission ({}) is not rendered", at, name, emission));
  }
}

}  // namespace penumbra
