#include "scenes/directives.h"

#include "scenes/transforms.h"

namespace penumbra {
namespace {

using Place = Directive::Place;

absl::Status translate(SceneBuilder& b, Statement& s) {
  return b.concatenate(translation(s.vector(0)), s.loc);
}
absl::Status scale(SceneBuilder& b, Statement& s) {
  return b.concatenate(scaling(s.vector(0)), s.loc);
}
absl::Status identity(SceneBuilder& b, Statement& s) {
  return b.set_transform(Matrix(), s.loc);
}
absl::Status transform(SceneBuilder& b, Statement& s) {
  return b.set_transform(matrix_of(s.numbers), s.loc);
}
absl::Status concat_transform(SceneBuilder& b, Statement& s) {
  return b.concatenate(matrix_of(s.numbers), s.loc);
}

absl::Status rotate(SceneBuilder& b, Statement& s) {
  const auto m = rotation(s.numbers[0], s.vector(1));
  return m ? b.concatenate(*m, s.loc) : b.error(s.loc, "Rotate: the axis is 0 0 0");
}

absl::Status look_at_directive(SceneBuilder& b, Statement& s) {
  const auto m = look_at(s.vector(0), s.vector(3), s.vector(6));
  return m ? b.concatenate(*m, s.loc)
           : b.error(s.loc, "LookAt: eye and target coincide, or the up vector lies along the view");
}

absl::Status transform_times(SceneBuilder& b, Statement& s) {
  return b.set_transform_times(s.numbers[0], s.numbers[1], s.loc);
}

absl::Status coordinate_system(SceneBuilder& b, Statement& s) {
  b.name_coordinate_system(s.strings[0]);
  return absl::OkStatus();
}

absl::Status coord_sys_transform(SceneBuilder& b, Statement& s) {
  b.use_coordinate_system(s.strings[0], s.loc);
  return absl::OkStatus();
}

absl::Status active_transform(SceneBuilder& b, Statement& s) {
  return b.choose_active_transforms(s.strings[0], s.loc);
}

template <PluginKind kind>
absl::Status option(SceneBuilder& b, Statement& s) {
  return b.set_option(kind, s.entity());
}

absl::Status camera(SceneBuilder& b, Statement& s) {
  return b.set_camera(s.entity());
}

/// v4's switches of its own renderer (Option, ColorSpace): nothing of ours depends on them.
absl::Status no_effect(SceneBuilder&, Statement&) {
  return absl::OkStatus();
}

absl::Status color_space(SceneBuilder& b, Statement& s) {
  if (s.strings[0] != "srgb")
    b.warn(s.loc, fmt::format("ColorSpace \"{}\" is read as srgb", printable(s.strings[0])));
  return absl::OkStatus();
}

absl::Status attribute_begin(SceneBuilder& b, Statement& s) {
  return b.begin_attributes(s.loc);
}
absl::Status transform_begin(SceneBuilder& b, Statement& s) {
  return b.begin_transform(s.loc);
}
absl::Status attribute_end(SceneBuilder& b, Statement& s) {
  b.end_attributes(s.loc);
  return absl::OkStatus();
}
absl::Status transform_end(SceneBuilder& b, Statement& s) {
  b.end_transform(s.loc);
  return absl::OkStatus();
}

absl::Status attribute(SceneBuilder& b, Statement& s) {
  return b.add_defaults(s.strings[0], std::move(s.params), s.loc);
}

absl::Status reverse_orientation(SceneBuilder& b, Statement&) {
  b.reverse_orientation();
  return absl::OkStatus();
}

absl::Status material(SceneBuilder& b, Statement& s) {
  b.set_material(s.entity());
  return absl::OkStatus();
}

absl::Status make_named_material(SceneBuilder& b, Statement& s) {
  return b.name_material(s.strings[0], std::move(s.params), s.loc);
}

absl::Status named_material(SceneBuilder& b, Statement& s) {
  b.use_material(s.strings[0], s.loc);
  return absl::OkStatus();
}

absl::Status make_named_medium(SceneBuilder& b, Statement& s) {
  b.name_medium(s.strings[0], std::move(s.params), s.loc);
  return absl::OkStatus();
}

absl::Status medium_interface(SceneBuilder& b, Statement& s) {
  b.set_media(s.strings.front(), s.strings.back());  // one name: the same on both sides
  return absl::OkStatus();
}

absl::Status texture(SceneBuilder& b, Statement& s) {
  return b.add_texture(s.strings[0], s.strings[1], s.entity(2));
}

absl::Status world_begin(SceneBuilder& b, Statement& s) {
  b.begin_world(s.loc);
  return absl::OkStatus();
}
absl::Status world_end(SceneBuilder& b, Statement& s) {
  b.end_world(s.loc);
  return absl::OkStatus();
}

absl::Status light_source(SceneBuilder& b, Statement& s) {
  return b.add_light(s.entity());
}
absl::Status area_light_source(SceneBuilder& b, Statement& s) {
  return b.set_area_light(s.entity());
}
absl::Status shape(SceneBuilder& b, Statement& s) {
  return b.add_shape(s.entity());
}
absl::Status object_begin(SceneBuilder& b, Statement& s) {
  return b.begin_object(s.strings[0], s.loc);
}
absl::Status object_end(SceneBuilder& b, Statement& s) {
  return b.end_object(s.loc);
}
absl::Status object_instance(SceneBuilder& b, Statement& s) {
  return b.add_instance(s.strings[0], s.loc);
}

// Places are pbrt-v3's: what stands elsewhere is left out there too (v4 refuses it).
constexpr Directive kDirectives[] = {
    // name, place, numbers, strings, optional strings, params, meaning
    {"Shape", Place::kInWorld, 0, 1, 0, true, shape},
    {"NamedMaterial", Place::kInWorld, 0, 1, 0, false, named_material},
    {"AttributeBegin", Place::kInWorld, 0, 0, 0, false, attribute_begin},
    {"AttributeEnd", Place::kInWorld, 0, 0, 0, false, attribute_end},
    {"Transform", Place::kAnywhere, 16, 0, 0, false, transform},
    {"ConcatTransform", Place::kAnywhere, 16, 0, 0, false, concat_transform},
    {"Translate", Place::kAnywhere, 3, 0, 0, false, translate},
    {"Scale", Place::kAnywhere, 3, 0, 0, false, scale},
    {"Rotate", Place::kAnywhere, 4, 0, 0, false, rotate},
    {"LookAt", Place::kAnywhere, 9, 0, 0, false, look_at_directive},
    {"Identity", Place::kAnywhere, 0, 0, 0, false, identity},
    {"CoordinateSystem", Place::kAnywhere, 0, 1, 0, false, coordinate_system},
    {"CoordSysTransform", Place::kAnywhere, 0, 1, 0, false, coord_sys_transform},
    {"ActiveTransform", Place::kAnywhere, 0, 1, 0, false, active_transform},
    {"TransformTimes", Place::kBeforeWorld, 2, 0, 0, false, transform_times},
    {"TransformBegin", Place::kInWorld, 0, 0, 0, false, transform_begin},
    {"TransformEnd", Place::kInWorld, 0, 0, 0, false, transform_end},
    {"ObjectInstance", Place::kInWorld, 0, 1, 0, false, object_instance},
    {"ObjectBegin", Place::kInWorld, 0, 1, 0, false, object_begin},
    {"ObjectEnd", Place::kInWorld, 0, 0, 0, false, object_end},
    {"Texture", Place::kInWorld, 0, 3, 0, true, texture},
    {"Material", Place::kInWorld, 0, 1, 0, true, material},
    {"MakeNamedMaterial", Place::kInWorld, 0, 1, 0, true, make_named_material},
    {"MakeNamedMedium", Place::kAnywhere, 0, 1, 0, true, make_named_medium},
    {"MediumInterface", Place::kAnywhere, 0, 1, 1, false, medium_interface},
    {"AreaLightSource", Place::kInWorld, 0, 1, 0, true, area_light_source},
    {"LightSource", Place::kInWorld, 0, 1, 0, true, light_source},
    {"ReverseOrientation", Place::kInWorld, 0, 0, 0, false, reverse_orientation},
    {"Attribute", Place::kAnywhere, 0, 1, 0, true, attribute},
    {"WorldBegin", Place::kAnywhere, 0, 0, 0, false, world_begin},
    {"WorldEnd", Place::kInWorld, 0, 0, 0, false, world_end},
    {"Camera", Place::kBeforeWorld, 0, 1, 0, true, camera},
    {"Film", Place::kBeforeWorld, 0, 1, 0, true, option<PluginKind::kFilm>},
    {"Sampler", Place::kBeforeWorld, 0, 1, 0, true, option<PluginKind::kSampler>},
    {"PixelFilter", Place::kBeforeWorld, 0, 1, 0, true, option<PluginKind::kFilter>},
    {"Integrator", Place::kBeforeWorld, 0, 1, 0, true, option<PluginKind::kIntegrator>},
    {"Accelerator", Place::kBeforeWorld, 0, 1, 0, true, option<PluginKind::kAccelerator>},
    {"ColorSpace", Place::kAnywhere, 0, 1, 0, false, color_space},
    {"Option", Place::kAnywhere, 0, 0, 0, true, no_effect},
};

}  // namespace

const Directive* find_directive(std::string_view name) {
  for (const Directive& directive : kDirectives)
    if (directive.name == name) return &directive;
  return nullptr;
}

}  // namespace penumbra
