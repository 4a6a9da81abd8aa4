#include "worker/textures/textures.h"

namespace penumbra {

FloatValue float_value(const Params& params, std::string_view name, float fallback) {
  const Param* param = params.find(name);
  if (param == nullptr) return {fallback};
  if (param->type == "texture") return {fallback, param->texture};
  return {static_cast<float>(params.number(name, fallback))};
}

absl::StatusOr<RgbValue> rgb_value(const Params& params, std::string_view name, Rgb fallback,
                                   const SceneDescription& description, const SceneFiles& files) {
  const Param* param = params.find(name);
  if (param == nullptr) return RgbValue{fallback};
  if (param->type == "texture") return RgbValue{fallback, param->texture};
  const absl::StatusOr<Rgb> color = to_rgb(*param, description, files);
  if (!color.ok()) return color.status();
  return RgbValue{*color};
}

}  // namespace penumbra
