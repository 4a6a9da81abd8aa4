#include "worker/materials/material_builder.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "proto/status.h"
#include "scenes/substitutes.h"
#include "worker/textures/image_file.h"
#include "worker/textures/named_spectra.h"

namespace penumbra {
namespace {

constexpr float kUnbounded = std::numeric_limits<float>::max();

bool is_one_of(std::string_view word, std::initializer_list<std::string_view> words) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

}  // namespace

absl::Status MaterialBuilder::complain(const FileLoc& loc, const std::string& message) {
  return complain(fmt::format("{}: {}", description_.place(loc), message));
}

absl::Status MaterialBuilder::complain(std::string text) {
  if (strict_) return absl::InvalidArgumentError(text);
  warnings_.push_back(std::move(text));
  return absl::OkStatus();
}

absl::StatusOr<RgbValue> MaterialBuilder::color(const MaterialEntity& entity, std::string_view name,
                                                Rgb fallback) {
  const auto read = rgb_value(entity.params, name, fallback, description_, files_);
  if (absl::IsNotFound(read.status())) {
    if (strict_) return absl::InvalidArgumentError(read.status().message());
    warnings_.push_back(message_of(read.status()) + ": the material's default instead");
    return RgbValue{fallback};
  }
  ASSIGN_OR_RETURN(const RgbValue value, read);
  const Rgb& c = value.constant;
  // Spectra outside the gamut are a little negative in RGB; what the user wrote as RGB must not be.
  const Param* param = entity.params.find(name);
  const bool written = param != nullptr && is_one_of(param->type, {"rgb", "float"});
  if (!std::isfinite(c.x + c.y + c.z) || (written && std::min({c.x, c.y, c.z}) < 0)) {
    return invalid_input("{}: {} ({}, {}, {}) must be finite and not negative",
                         description_.place(param->loc), name, c.x, c.y, c.z);
  }
  return RgbValue{{std::max(0.0f, c.x), std::max(0.0f, c.y), std::max(0.0f, c.z)}, value.texture};
}

absl::StatusOr<FloatValue> MaterialBuilder::number(const MaterialEntity& entity, std::string_view name,
                                                   float fallback, float least, float most) {
  const FloatValue value = float_value(entity.params, name, fallback);
  if (value.texture < 0 && !(value.constant >= least && value.constant <= most)) {
    return invalid_input("{}: {} {} is not in [{}, {}]", description_.place(entity.params.find(name)->loc),
                         name, value.constant, least, most);
  }
  return value;
}

absl::StatusOr<FloatValue> MaterialBuilder::index_of_refraction(const MaterialEntity& entity,
                                                                std::string_view name) {
  const Param* param = entity.params.find(name);
  if (param == nullptr || param->type == "float" || param->type == "texture") {
    return number(entity, name, 1.5f, std::numeric_limits<float>::min(), kUnbounded);
  }
  // A spectrum ("glass-BK7"): no dispersion here, the green channel stands for all.
  ASSIGN_OR_RETURN(const RgbValue value, color(entity, name, Rgb(1.5f)));
  if (!(value.constant.y > 0)) {
    return invalid_input("{}: {} must be above 0", description_.place(param->loc), name);
  }
  return FloatValue{value.constant.y};
}

absl::StatusOr<Roughness> MaterialBuilder::roughness(const MaterialEntity& entity, float fallback,
                                                     Remap remap, Smooth smooth, std::string_view prefix) {
  const std::string name(prefix);
  Roughness out;
  out.smooth = smooth;
  out.remap = entity.params.boolean(name + "remaproughness", true) ? remap : Remap::kDirect;
  ASSIGN_OR_RETURN(const FloatValue both, number(entity, name + "roughness", fallback, 0, kUnbounded));
  const auto along = [&](const std::string& axis) -> absl::StatusOr<FloatValue> {
    if (entity.params.find(axis) == nullptr) return both;
    return number(entity, axis, both.constant, 0, kUnbounded);
  };
  ASSIGN_OR_RETURN(out.u, along(name + "uroughness"));
  ASSIGN_OR_RETURN(out.v, along(name + "vroughness"));
  out.constant_alpha_u = alpha_of(out.u.constant, out.remap);
  out.constant_alpha_v = alpha_of(out.v.constant, out.remap);
  return out;
}

// Of several of one name the last counts, wherever the mix stands: v4's rule, and v3's for scenes that do
// not define a name twice.
absl::StatusOr<int> MaterialBuilder::material_named(const MaterialEntity& entity, const std::string& name) {
  const auto& all = description_.materials;
  for (size_t i = all.size(); i-- > 0;) {
    if (!name.empty() && all[i].name == name) return static_cast<int>(i);
  }
  RETURN_IF_ERROR(complain(entity.loc, fmt::format("no material is named '{}': matte instead", name)));
  return -1;
}

absl::StatusOr<Material> MaterialBuilder::build(const MaterialEntity& entity) {
  Material material;
  ASSIGN_OR_RETURN(material.kind, build_kind(entity));
  const char* bump = entity.params.find("displacement") != nullptr ? "displacement" : "bumpmap";
  material.bump = float_value(entity.params, bump, 0);
  ASSIGN_OR_RETURN(material.normal_map, normal_map(entity));
  return material;
}

absl::StatusOr<std::shared_ptr<const Image>> MaterialBuilder::normal_map(const MaterialEntity& entity) {
  const Param* param = entity.params.find("normalmap");
  const std::string name = entity.params.string("normalmap", "");
  if (param == nullptr || name.empty()) return nullptr;
  const auto path = files_.path_of(name);
  const absl::StatusOr<Texels> texels =
      path.ok() ? read_image(*path, false, Encoding{Encoding::kLinear}) : path.status();
  if (texels.ok()) return std::make_shared<const Image>(*texels);
  RETURN_IF_ERROR(complain(missing_normal_map_text(*param, message_of(texels.status()), description_)));
  return nullptr;
}

MaterialBuilder::Built MaterialBuilder::build_kind(const MaterialEntity& entity) {
  const std::string& type = entity.type;
  if (is_one_of(type, {"", "none", "interface"})) return InterfaceMaterial{};
  if (type == "mix") return mix(entity);
  if (type == "hair") return hair(entity);
  if (is_one_of(type, {"matte", "plastic", "metal", "substrate", "uber", "mirror", "glass", "translucent"})) {
    return build_v3(entity);
  }
  if (is_one_of(type, {"diffuse", "coateddiffuse", "conductor", "coatedconductor", "dielectric",
                       "thindielectric", "diffusetransmission"})) {
    return build_v4(entity);
  }
  return build_nearest(entity);
}

MaterialBuilder::Built MaterialBuilder::build_v3(const MaterialEntity& entity) {
  const std::string& type = entity.type;
  if (type == "matte") return matte(entity, "Kd", 0.5f);
  if (type == "plastic") return plastic(entity);
  if (type == "metal") return metal(entity);
  if (type == "substrate") return substrate(entity);
  if (type == "uber") return uber(entity);
  if (type == "glass") return glass(entity);
  if (type == "translucent") return translucent(entity);
  ASSIGN_OR_RETURN(const RgbValue kr, color(entity, "Kr", Rgb(0.9f)));
  return MirrorMaterial{kr};
}

MaterialBuilder::Built MaterialBuilder::matte(const MaterialEntity& entity, std::string_view name,
                                              float fallback) {
  ASSIGN_OR_RETURN(const RgbValue kd, color(entity, name, Rgb(fallback)));
  ASSIGN_OR_RETURN(const FloatValue sigma, number(entity, "sigma", 0, 0, 90));
  return MatteMaterial{kd, sigma};
}

MaterialBuilder::Built MaterialBuilder::plastic(const MaterialEntity& entity) {
  ASSIGN_OR_RETURN(const RgbValue kd, color(entity, "Kd", Rgb(0.25f)));
  ASSIGN_OR_RETURN(const RgbValue ks, color(entity, "Ks", Rgb(0.25f)));
  ASSIGN_OR_RETURN(const Roughness rough, roughness(entity, 0.1f, Remap::kV3, Smooth::kNever));
  return PlasticMaterial{kd, ks, rough};
}

MaterialBuilder::Built MaterialBuilder::metal(const MaterialEntity& entity) {
  ASSIGN_OR_RETURN(const RgbValue eta, color(entity, "eta", copper().eta));
  ASSIGN_OR_RETURN(const RgbValue k, color(entity, "k", copper().k));
  ASSIGN_OR_RETURN(const Roughness rough, roughness(entity, 0.01f, Remap::kV3, Smooth::kNever));
  return MetalMaterial{eta, k, rough};
}

MaterialBuilder::Built MaterialBuilder::substrate(const MaterialEntity& entity) {
  ASSIGN_OR_RETURN(const RgbValue kd, color(entity, "Kd", Rgb(0.5f)));
  ASSIGN_OR_RETURN(const RgbValue ks, color(entity, "Ks", Rgb(0.5f)));
  ASSIGN_OR_RETURN(const Roughness rough, roughness(entity, 0.1f, Remap::kV3, Smooth::kNever));
  return SubstrateMaterial{kd, ks, rough};
}

MaterialBuilder::Built MaterialBuilder::uber(const MaterialEntity& entity) {
  UberMaterial m;
  ASSIGN_OR_RETURN(m.kd, color(entity, "Kd", Rgb(0.25f)));
  ASSIGN_OR_RETURN(m.ks, color(entity, "Ks", Rgb(0.25f)));
  ASSIGN_OR_RETURN(m.kr, color(entity, "Kr", Rgb(0)));
  ASSIGN_OR_RETURN(m.kt, color(entity, "Kt", Rgb(0)));
  ASSIGN_OR_RETURN(m.opacity, color(entity, "opacity", Rgb(1)));
  ASSIGN_OR_RETURN(m.eta,
                   index_of_refraction(entity, entity.params.find("eta") != nullptr ? "eta" : "index"));
  ASSIGN_OR_RETURN(m.roughness, roughness(entity, 0.1f, Remap::kV3, Smooth::kNever));
  return m;
}

MaterialBuilder::Built MaterialBuilder::glass(const MaterialEntity& entity) {
  GlassMaterial m;
  ASSIGN_OR_RETURN(m.kr, color(entity, "Kr", Rgb(1)));
  ASSIGN_OR_RETURN(m.kt, color(entity, "Kt", Rgb(1)));
  ASSIGN_OR_RETURN(m.eta,
                   index_of_refraction(entity, entity.params.find("eta") != nullptr ? "eta" : "index"));
  ASSIGN_OR_RETURN(m.roughness, roughness(entity, 0, Remap::kV3, Smooth::kZeroRoughness));
  return m;
}

MaterialBuilder::Built MaterialBuilder::translucent(const MaterialEntity& entity) {
  TranslucentMaterial m;
  ASSIGN_OR_RETURN(m.kd, color(entity, "Kd", Rgb(0.25f)));
  ASSIGN_OR_RETURN(m.ks, color(entity, "Ks", Rgb(0.25f)));
  ASSIGN_OR_RETURN(m.reflect, color(entity, "reflect", Rgb(0.5f)));
  ASSIGN_OR_RETURN(m.transmit, color(entity, "transmit", Rgb(0.5f)));
  ASSIGN_OR_RETURN(m.roughness, roughness(entity, 0.1f, Remap::kV3, Smooth::kNever));
  return m;
}

MaterialBuilder::Built MaterialBuilder::mix(const MaterialEntity& entity) {
  MixMaterial m;
  ASSIGN_OR_RETURN(m.amount, color(entity, "amount", Rgb(0.5f)));
  const Param* names = entity.params.find("materials");
  if (names == nullptr) {  // v3: amount weights the first
    ASSIGN_OR_RETURN(m.first, material_named(entity, entity.params.string("namedmaterial1", "")));
    ASSIGN_OR_RETURN(m.second, material_named(entity, entity.params.string("namedmaterial2", "")));
    return m;
  }
  if (names->strings.size() != 2) {
    return invalid_input("{}: a mix needs the names of 2 materials, not {}", description_.place(names->loc),
                         names->strings.size());
  }
  ASSIGN_OR_RETURN(m.first, material_named(entity, names->strings[1]));  // v4: amount weights the second
  ASSIGN_OR_RETURN(m.second, material_named(entity, names->strings[0]));
  return m;
}

}  // namespace penumbra
