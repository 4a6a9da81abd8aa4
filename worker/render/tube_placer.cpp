#include "worker/render/tube_placer.h"

#include <algorithm>

#include "proto/status.h"

namespace penumbra {

absl::Status TubePlacer::add(const ShapeEntity& shape, const Matrix& to_world) {
  std::vector<std::string> said;  // of normals that are left out: once for all curves is enough
  ASSIGN_OR_RETURN(const Curve curve, curve_of(shape, description_, files_, said));
  if (!said.empty()) warn_once("only ribbons have normals: N is left out of curves", shape);
  if (shape.area_light >= 0) warn_once("curves do not emit (as in pbrt)", shape);
  const FloatValue alpha = float_value(shape.params, "alpha", 1);
  if (alpha.texture >= 0) warn_once("a curve's alpha texture is not supported: opaque instead", shape);
  if (alpha.texture < 0 && !(alpha.constant > 0)) return absl::OkStatus();
  if (scene_->materials.is_interface(shape.material)) return absl::OkStatus();
  Group& group = groups_[{shape.material, curve.type == CurveType::kFlat}];
  if (group.shape == nullptr) group.shape = &shape;
  if (!add_tubes(curve, to_world, group.tubes))
    warn_once("a curve's transform is no similarity: its cross-section stays round", shape);
  if (group.tubes.points.size() >= kNone)
    return make_status(absl::StatusCode::kResourceExhausted, "{}: curves of more than {} points",
                       description_.place(shape.loc), kNone);
  return absl::OkStatus();
}

std::vector<TubePlacer::Placed> TubePlacer::finish() {
  std::vector<Placed> all;
  for (auto& [key, group] : groups_) {
    SceneMesh mesh;
    mesh.material = key.first;
    group.tubes.facing = key.second;
    group.tubes.points.shrink_to_fit();
    group.tubes.us.shrink_to_fit();
    group.tubes.segments.shrink_to_fit();
    mesh.tubes = std::make_unique<const Tubes>(std::move(group.tubes));
    all.push_back({std::move(mesh), group.shape});
  }
  groups_.clear();
  return all;
}

void TubePlacer::warn_once(const char* what, const ShapeEntity& shape) {
  if (std::find(said_.begin(), said_.end(), what) != said_.end()) return;
  said_.push_back(what);
  warnings_.push_back(fmt::format("{}: {}", description_.place(shape.loc), what));
}

}  // namespace penumbra
