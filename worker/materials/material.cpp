#include "worker/materials/material.h"

#include "proto/status.h"
#include "scenes/worn_materials.h"
#include "worker/materials/bump.h"
#include "worker/materials/material_builder.h"
#include "worker/materials/material_kinds.h"

namespace penumbra {
namespace {

/// Levels of mixes of mixes, and materials evaluated for one: far beyond any real scene, and safe.
constexpr int kMostDepth = 64, kMostEvaluations = 256;

/// Bounds of every material, mixes after what they mix; refuses those that a Bsdf cannot hold, and mixes
/// that contain themselves.
class Bounds {
 public:
  Bounds(const std::vector<Material>& materials, const SceneDescription& description)
      : materials_(materials),
        description_(description),
        states_(materials.size(), kNew),
        bounds_(materials.size()) {}

  absl::StatusOr<std::vector<LobeBounds>> all() {
    for (size_t i = 0; i < materials_.size(); ++i) RETURN_IF_ERROR(visit(static_cast<int>(i), 0));
    return std::move(bounds_);
  }

 private:
  enum State : uint8_t { kNew, kOpen, kDone };

  absl::Status visit(int i, int depth) {
    if (i < 0 || states_[i] == kDone) return absl::OkStatus();
    const auto fault = [&](const char* what) {
      return invalid_input("{}: {}", description_.place(description_.materials[i].loc), what);
    };
    if (states_[i] == kOpen) return fault("a mix that contains itself");
    if (depth > kMostDepth) return fault("mixes nested too deep");
    states_[i] = kOpen;
    if (const auto* mix = std::get_if<MixMaterial>(&materials_[i].kind)) {
      RETURN_IF_ERROR(visit(mix->first, depth + 1));
      RETURN_IF_ERROR(visit(mix->second, depth + 1));
    }
    bounds_[i] = lobe_bounds(materials_[i].kind, bounds_);
    if (bounds_[i].lobes > Bsdf::kMostLobes || bounds_[i].evaluations > kMostEvaluations) {
      return invalid_input("{}: a mix of {} lobes; at most {} are possible",
                           description_.place(description_.materials[i].loc), bounds_[i].lobes,
                           Bsdf::kMostLobes);
    }
    states_[i] = kDone;
    return absl::OkStatus();
  }

  const std::vector<Material>& materials_;
  const SceneDescription& description_;
  std::vector<State> states_;
  std::vector<LobeBounds> bounds_;
};

/// Materials that something wears, as indices; the others are not built, load nothing and warn of nothing.
std::vector<int> worn_indices(const SceneDescription& description) {
  std::vector<int> indices;
  for (const MaterialEntity* entity : worn_materials(description)) {
    indices.push_back(static_cast<int>(entity - description.materials.data()));
  }
  return indices;
}

/// Textures that the worn materials' parameters name, and those that these name. A texture names earlier
/// ones only.
std::vector<bool> used_by(const SceneDescription& description) {
  std::vector<bool> used(description.textures.size());
  const auto mark = [&](const Params& params) {
    for (const Param& param : params.all) {
      if (param.type == "texture" && param.texture >= 0) used[param.texture] = true;
    }
  };
  for (const MaterialEntity* entity : worn_materials(description)) mark(entity->params);
  for (size_t i = used.size(); i-- > 0;) {
    if (used[i]) mark(description.textures[i].params);
  }
  return used;
}

}  // namespace

struct Materials::Parts {
  std::vector<Material> materials;
  std::vector<LobeBounds> bounds;
  std::vector<bool> used_textures;

  const Material& at(int material) const { return material < 0 ? default_material() : materials[material]; }
  /// The material whose bump map counts: of a mix, that of its first material, as in pbrt-v3.
  const Material& bumped(int material) const {
    const Material* m = &at(material);
    while (const auto* mix = std::get_if<MixMaterial>(&m->kind)) m = &at(mix->first);
    return *m;
  }
};

Materials::Materials() : parts_(std::make_unique<Parts>()) {}
Materials::Materials(Materials&&) noexcept = default;
Materials& Materials::operator=(Materials&&) noexcept = default;
Materials::~Materials() = default;

absl::StatusOr<Materials> Materials::build(const SceneDescription& description, const SceneFiles& files,
                                           bool strict, std::vector<std::string>& warnings) {
  Materials result;
  Parts& parts = *result.parts_;
  MaterialBuilder builder(description, files, strict, warnings);
  parts.materials.resize(description.materials.size());
  for (const int i : worn_indices(description)) {
    ASSIGN_OR_RETURN(parts.materials[i], builder.build(description.materials[i]));
  }
  ASSIGN_OR_RETURN(parts.bounds, Bounds(parts.materials, description).all());
  parts.used_textures = used_by(description);
  return result;
}

const std::vector<bool>& Materials::used_textures() const {
  return parts_->used_textures;
}

Bsdf Materials::shade(int material, const SurfacePoint& point, const Textures& textures) const {
  const Material& m = parts_->at(material);
  const Material& bump = parts_->bumped(material);
  if (!bump.displaced()) {
    Bsdf bsdf(point, point.ns);
    add_lobes(m.kind, {parts_->materials, point, textures}, Rgb(1), bsdf);
    return bsdf;
  }
  const SurfacePoint moved = displaced(bump, point, textures);
  Bsdf bsdf(moved, moved.ns);
  add_lobes(m.kind, {parts_->materials, point, textures}, Rgb(1), bsdf);
  return bsdf;
}

bool Materials::is_interface(int material) const {
  return std::holds_alternative<InterfaceMaterial>(parts_->at(material).kind);
}

bool Materials::has_bump(int material) const {
  return parts_->bumped(material).displaced();
}

bool Materials::has_specular(int material) const {
  return material >= 0 && parts_->bounds[material].specular;
}

}  // namespace penumbra
