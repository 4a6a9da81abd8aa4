// The half of SceneBuilder that fills the world: materials, textures, lights, shapes, instances; and the
// names that are resolved when everything is known.
#include "scenes/each_params.h"
#include "scenes/scene_builder.h"
#include "scenes/texture_names.h"

namespace penumbra {
namespace {

/// Indices of names that are not defined yet are stored as -2 - k, k into a list of forward names.
int forward_code(size_t k) {
  return -2 - static_cast<int>(k);
}
bool is_forward(int code) {
  return code <= -2;
}
size_t forward_index(int code) {
  return static_cast<size_t>(-2 - code);
}

}  // namespace

// ---- materials and textures ----

void SceneBuilder::set_material(Entity entity) {
  if (entity.type.empty()) entity.type = "none";
  static_cast<void>(check_name(PluginKind::kMaterial, entity));  // only warns
  prepend_defaults("material", entity.params);
  resolve_textures(entity.type, entity.params);
  state_.material = static_cast<int>(description_.materials.size());
  description_.materials.push_back({std::move(entity), {}});
}

absl::Status SceneBuilder::name_material(const std::string& name, Params params, FileLoc loc) {
  MaterialEntity material;
  material.name = name;
  material.loc = loc;
  prepend_defaults("material", params);
  const Param* const type = params.find("type");
  if (!type || type->type != "string" || type->strings.empty())
    return diagnostics_.error(loc, "MakeNamedMaterial \"{}\" has no \"string type\"", printable(name));
  material.type = type->strings[0].empty() ? "none" : type->strings[0];
  material.params = std::move(params);
  static_cast<void>(check_name(PluginKind::kMaterial, material));  // only warns
  resolve_textures(material.type, material.params);
  materials_.define(name, static_cast<int>(description_.materials.size()));
  description_.materials.push_back(std::move(material));
  return absl::OkStatus();
}

void SceneBuilder::use_material(const std::string& name, FileLoc loc) {
  state_.material = materials_.find(name);
  if (state_.material >= 0) return;
  state_.material = forward_code(forward_materials_.size());
  forward_materials_.push_back({name, loc});
}

absl::Status SceneBuilder::add_texture(const std::string& name, const std::string& value_type,
                                       Entity entity) {
  TextureEntity texture;
  texture.is_float = value_type == "float";
  if (!texture.is_float && value_type != "spectrum" && value_type != "color")
    return diagnostics_.error(entity.loc, "texture \"{}\": its values are float, spectrum or color, not '{}'",
                              printable(name), printable(value_type));
  static_cast<void>(check_name(PluginKind::kTexture, entity));  // only warns
  prepend_defaults("texture", entity.params);
  ASSIGN_OR_RETURN(texture.placement, placement("texture", entity.loc));
  // A texture sees the textures before it, also an earlier one of its own name.
  resolve_textures(texture.is_float ? "float texture" : "spectrum texture", entity.params);
  static_cast<Entity&>(texture) = std::move(entity);
  texture.name = name;
  ScopedNames& names = texture.is_float ? float_textures_ : spectrum_textures_;
  names.define(name, static_cast<int>(description_.textures.size()));
  description_.textures.push_back(std::move(texture));
  return absl::OkStatus();
}

int SceneBuilder::find_texture(const std::string& owner, const Param& param) const {
  TextureSpace space = texture_space(owner, param.name);
  if (owner == "float texture") space = TextureSpace::kFloat;
  if (owner == "spectrum texture")
    space = param.name == "amount" || param.name == "scale" ? TextureSpace::kEither : TextureSpace::kSpectrum;
  const std::string& name = param.strings[0];
  if (space == TextureSpace::kFloat) return float_textures_.find(name);
  const int spectrum = spectrum_textures_.find(name);
  return spectrum >= 0 || space == TextureSpace::kSpectrum ? spectrum : float_textures_.find(name);
}

void SceneBuilder::resolve_texture(const std::string& owner, Param& param) {
  if (param.type == "texture" && param.texture < 0 && !param.strings.empty())
    param.texture = find_texture(owner, param);
}

void SceneBuilder::resolve_textures(const std::string& owner, Params& params) {
  for (Param& param : params.all) resolve_texture(owner, param);
}

// ---- the world ----

void SceneBuilder::begin_world(FileLoc loc) {
  if (phase_ != Phase::kOptions) {
    diagnostics_.warn(loc, "WorldBegin inside the world: ignored");
    return;
  }
  phase_ = Phase::kWorld;
  description_.has_world = true;
  transforms_ = {};
  coordinate_systems_["world"] = transforms_.ctm;
}

void SceneBuilder::end_world(FileLoc loc) {
  if (!saved_.empty())
    diagnostics_.warn(loc, "{} AttributeBegin or ObjectBegin without an end", saved_.size());
  phase_ = Phase::kAfterWorld;
}

absl::Status SceneBuilder::add_light(Entity entity) {
  RETURN_IF_ERROR(check_name(PluginKind::kLight, entity));
  prepend_defaults("light", entity.params);
  LightEntity light;
  const bool at_infinity =
      entity.type == "infinite" || entity.type == "exinfinite" || entity.type == "distant";
  ASSIGN_OR_RETURN(light.placement, at_infinity ? placement_at_infinity("light source", entity.loc)
                                                : placement("light source", entity.loc));
  resolve_textures(entity.type, entity.params);
  static_cast<Entity&>(light) = std::move(entity);
  description_.lights.push_back(std::move(light));
  return absl::OkStatus();
}

absl::Status SceneBuilder::set_area_light(Entity entity) {
  RETURN_IF_ERROR(check_name(PluginKind::kAreaLight, entity));
  if (entity.type == "area") entity.type = "diffuse";  // pbrt-v2's name for it
  prepend_defaults("light", entity.params);
  resolve_textures(entity.type, entity.params);
  state_.area_light = static_cast<int>(description_.area_lights.size());
  description_.area_lights.push_back(std::move(entity));
  return absl::OkStatus();
}

absl::Status SceneBuilder::add_shape(Entity entity) {
  RETURN_IF_ERROR(check_name(PluginKind::kShape, entity));
  prepend_defaults("shape", entity.params);
  ShapeEntity shape;
  ASSIGN_OR_RETURN(shape.placement, placement("shape", entity.loc));
  resolve_textures(entity.type, entity.params);
  static_cast<Entity&>(shape) = std::move(entity);
  shape.reverse_orientation = state_.reverse_orientation;
  shape.material = state_.material;
  shape.area_light = state_.area_light;
  shape.inside_medium = state_.inside_medium;
  shape.outside_medium = state_.outside_medium;
  if (open_object_ < 0) {
    description_.shapes.push_back(std::move(shape));
    return absl::OkStatus();
  }
  if (shape.area_light >= 0) {
    diagnostics_.warn(shape.loc, "an area light inside an object does not emit (as in pbrt)");
    shape.area_light = -1;
  }
  description_.objects[open_object_].shapes.push_back(std::move(shape));
  return absl::OkStatus();
}

absl::Status SceneBuilder::begin_object(const std::string& name, FileLoc loc) {
  if (open_object_ >= 0)
    return diagnostics_.error(loc, "ObjectBegin inside the object that begins at {}",
                              place_in(diagnostics_.files, open_object_loc_));
  RETURN_IF_ERROR(begin_attributes(loc));
  open_object_ = static_cast<int>(description_.objects.size());
  open_object_loc_ = loc;
  objects_[name] = open_object_;
  description_.objects.push_back({name, loc, {}});
  return absl::OkStatus();
}

absl::Status SceneBuilder::end_object(FileLoc loc) {
  if (open_object_ < 0) return diagnostics_.error(loc, "ObjectEnd without its ObjectBegin");
  open_object_ = -1;
  end_attributes(loc);
  return absl::OkStatus();
}

absl::Status SceneBuilder::add_instance(const std::string& name, FileLoc loc) {
  if (open_object_ >= 0)
    return diagnostics_.error(loc, "ObjectInstance inside the object that begins at {}",
                              place_in(diagnostics_.files, open_object_loc_));
  InstanceEntity instance;
  ASSIGN_OR_RETURN(instance.placement, placement("instance", loc));
  instance.loc = loc;
  if (const auto known = objects_.find(name); known != objects_.end()) {
    instance.object = known->second;
  } else {
    instance.object = forward_code(forward_instances_.size());
    forward_instances_.push_back({name, loc});
  }
  description_.instances.push_back(instance);
  return absl::OkStatus();
}

// ---- names that were used before they were defined ----

void SceneBuilder::resolve_forward_materials() {
  std::vector<int> found(forward_materials_.size());
  for (size_t k = 0; k < found.size(); ++k) {
    const auto& [name, loc] = forward_materials_[k];
    found[k] = materials_.find(name);
    if (found[k] < 0) diagnostics_.warn(loc, "no material '{}': the default matte instead", printable(name));
  }
  const auto resolve = [&found](std::vector<ShapeEntity>& shapes) {
    for (ShapeEntity& shape : shapes)
      if (is_forward(shape.material)) shape.material = found[forward_index(shape.material)];
  };
  resolve(description_.shapes);
  for (ObjectEntity& object : description_.objects) resolve(object.shapes);
}

void SceneBuilder::resolve_forward_instances() {
  std::erase_if(description_.instances, [this](InstanceEntity& instance) {
    if (!is_forward(instance.object)) return false;
    const auto& [name, loc] = forward_instances_[forward_index(instance.object)];
    if (const auto known = objects_.find(name); known != objects_.end()) {
      instance.object = known->second;
      return false;
    }
    diagnostics_.warn(loc, "no object '{}': the instance is left out", printable(name));
    return true;
  });
}

void SceneBuilder::warn_about_missing_textures() {
  each_params(description_, [this](const std::string& owner, Params& params) {
    resolve_textures(owner, params);
    for (const Param& param : params.all) {
      if (param.type != "texture" || param.texture >= 0) continue;
      diagnostics_.warn(param.loc, "\"texture {}\": no such texture '{}'", printable(param.name),
                        param.strings.empty() ? "" : printable(param.strings[0]));
    }
  });
}

SceneDescription SceneBuilder::finish(FileLoc end) {
  if (phase_ == Phase::kOptions) diagnostics_.warn(end, "no WorldBegin: there is nothing to render");
  if (open_object_ >= 0) diagnostics_.warn(open_object_loc_, "ObjectBegin without its ObjectEnd");
  resolve_forward_materials();
  resolve_forward_instances();
  warn_about_missing_textures();
  return std::move(description_);
}

}  // namespace penumbra
