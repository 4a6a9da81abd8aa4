// Lights that are not on a shape: point, spot, distant, infinite.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "proto/status.h"
#include "worker/render/light_params.h"
#include "worker/render/scene_builder.h"

namespace penumbra {
namespace {

absl::StatusOr<Rgb> strength(const LightEntity& light, std::string_view name, const SceneDescription& description,
                             const SceneFiles& files) {
  Rgb value(1);
  if (const Param* p = light.params.find(name)) {
    ASSIGN_OR_RETURN(value, to_rgb(*p, description, files));
  }
  apply_scale(light.params, value);
  return value;
}

}  // namespace

absl::Status add_light(const LightEntity& light, const SceneDescription& description, const SceneFiles& files,
                       bool strict, LightSet& lights, std::vector<std::string>& warnings) {
  const Matrix& m = light.placement.start;
  const Params& params = light.params;
  if (light.type == "infinite" || light.type == "exinfinite") {
    ASSIGN_OR_RETURN(Environment e, Environment::build(light, description, files, strict, warnings));
    if (e.mean_luminance() > 0) lights.environments.push_back(std::move(e));
    return absl::OkStatus();
  }
  if (light.type == "point") {
    PointEmitter e;
    e.position = Vec3f(transform_point(m, vector_param(params, "from")));
    ASSIGN_OR_RETURN(e.intensity, strength(light, "I", description, files));
    lights.delta.push_back(e);
  } else if (light.type == "spot") {
    const Vec3d from = transform_point(m, vector_param(params, "from"));
    const Vec3d to = transform_point(m, vector_param(params, "to", Vec3d(0, 0, 1)));
    if (from == to) return invalid_input("{}: a spot light needs `to` apart from `from`", description.place(light.loc));
    const double cone = params.number("coneangle", 30), delta = params.number("conedeltaangle", 5);
    SpotEmitter e;
    e.position = Vec3f(from);
    e.axis = Vec3f((to - from).normalized());
    e.cos_outer = float(std::cos(cone * std::numbers::pi / 180));
    e.cos_inner = float(std::cos((cone - delta) * std::numbers::pi / 180));
    ASSIGN_OR_RETURN(e.intensity, strength(light, "I", description, files));
    lights.delta.push_back(e);
  } else if (light.type == "distant") {
    const Vec3d from = vector_param(params, "from"), to = vector_param(params, "to", Vec3d(0, 0, 1));
    const Vec3d towards = transform_direction(m, from - to);
    if (!(towards.length2() > 0))
      return invalid_input("{}: a distant light needs `to` apart from `from`", description.place(light.loc));
    DistantEmitter e;
    e.towards_light = Vec3f(towards.normalized());
    ASSIGN_OR_RETURN(e.irradiance, strength(light, "L", description, files));
    lights.delta.push_back(e);
  }
  return absl::OkStatus();  // other types are named by unsupported()
}

}  // namespace penumbra
