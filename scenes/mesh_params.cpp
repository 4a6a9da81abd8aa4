#include "scenes/mesh_params.h"

namespace penumbra {

std::vector<Vec3f> vectors_of(const Params& params, std::string_view name, std::string_view type) {
  const Param* const param = params.find(name);
  std::vector<Vec3f> out;
  if (!param || param->type != type) return out;
  const std::vector<double>& x = param->numbers;
  out.reserve(x.size() / 3);
  for (size_t i = 0; i + 2 < x.size(); i += 3) out.emplace_back(Vec3d(x[i], x[i + 1], x[i + 2]));
  return out;
}

std::vector<Vec2f> uvs_of(const Params& params, std::initializer_list<std::string_view> names) {
  std::vector<Vec2f> out;
  for (const std::string_view name : names) {
    const Param* const param = params.find(name);
    if (!param || (param->type != "point2" && param->type != "float")) continue;
    const std::vector<double>& x = param->numbers;
    out.reserve(x.size() / 2);
    for (size_t i = 0; i + 1 < x.size(); i += 2) out.emplace_back(Vec2d(x[i], x[i + 1]));
    break;
  }
  return out;
}

absl::StatusOr<std::vector<uint32_t>> indices_of(const ShapeEntity& shape, size_t group,
                                                 const MeshContext& context) {
  std::vector<uint32_t> out;
  const Param* const param = shape.params.find("indices");
  if (!param || param->type != "integer") return out;
  if (param->numbers.size() % group != 0)
    return context.error(param->loc, "{} indices are no multiple of {}", param->numbers.size(), group);
  out.reserve(param->numbers.size());
  for (const double index : param->numbers) {
    if (index < 0) return context.error(param->loc, "index {} is negative", index);
    out.push_back(static_cast<uint32_t>(index));
  }
  return out;
}

}  // namespace penumbra
