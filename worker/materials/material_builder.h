#pragma once
// From a material's parameters to its kind.
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "worker/materials/material_kinds.h"

namespace penumbra {

/// Builds the materials of one scene. Errors and warnings are `file:line:column: …`.
class MaterialBuilder {
 public:
  MaterialBuilder(const SceneDescription& description, const SceneFiles& files, bool strict,
                  std::vector<std::string>& warnings)
      : description_(description), files_(files), strict_(strict), warnings_(warnings) {}

  absl::StatusOr<Material> build(const MaterialEntity& entity);

 private:
  using Built = absl::StatusOr<MaterialKind>;
  Built build_kind(const MaterialEntity& entity);
  Built build_v3(const MaterialEntity& entity);
  Built build_v4(const MaterialEntity& entity);
  Built build_nearest(const MaterialEntity& entity);
  Built matte(const MaterialEntity& entity, std::string_view color, float fallback);
  Built plastic(const MaterialEntity& entity);
  Built metal(const MaterialEntity& entity);
  Built substrate(const MaterialEntity& entity);
  Built uber(const MaterialEntity& entity);
  Built glass(const MaterialEntity& entity);
  Built translucent(const MaterialEntity& entity);
  Built hair(const MaterialEntity& entity);
  Built mix(const MaterialEntity& entity);
  absl::StatusOr<std::shared_ptr<const Image>> normal_map(const MaterialEntity& entity);
  Built conductor(const MaterialEntity& entity, std::string_view prefix);
  Built dielectric(const MaterialEntity& entity);
  Built coated_diffuse(const MaterialEntity& entity);
  Built diffuse_transmission(const MaterialEntity& entity);

  /// A colour of at least 0 per channel.
  absl::StatusOr<RgbValue> color(const MaterialEntity& entity, std::string_view name, Rgb fallback);
  /// A number in [least, most].
  absl::StatusOr<FloatValue> number(const MaterialEntity& entity, std::string_view name, float fallback,
                                    float least, float most);
  absl::StatusOr<FloatValue> index_of_refraction(const MaterialEntity& entity, std::string_view name);
  absl::StatusOr<Roughness> roughness(const MaterialEntity& entity, float fallback, Remap remap,
                                      Smooth smooth, std::string_view prefix = "");
  absl::StatusOr<int> material_named(const MaterialEntity& entity, const std::string& name);
  /// With strict the message as an error, else a warning and OK.
  absl::Status complain(const FileLoc& loc, const std::string& message);
  absl::Status complain(std::string text);

  const SceneDescription& description_;
  const SceneFiles& files_;
  bool strict_;
  std::vector<std::string>& warnings_;
};

}  // namespace penumbra
