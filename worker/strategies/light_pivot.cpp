#include "worker/strategies/light_pivot.h"

#include <algorithm>

namespace penumbra {
namespace {

struct PositionOf {
  std::optional<Vec3d> operator()(const PointEmitter& e) const { return Vec3d(e.position); }
  std::optional<Vec3d> operator()(const SpotEmitter& e) const { return Vec3d(e.position); }
  std::optional<Vec3d> operator()(const DistantEmitter&) const { return std::nullopt; }
};

}  // namespace

std::optional<Vec3d> light_pivot(const LightSet& lights, const Vec3d& near, double u, const Vec2d& v) {
  if (lights.size() == 0) return std::nullopt;
  size_t light = 0;
  if (lights.draws()) {
    const DrawnLight drawn = lights.draw({near, false, Vec3d(0)}, u);
    if (!(drawn.probability > 0)) return std::nullopt;
    light = drawn.light;
  } else {
    light = std::min(size_t(u * double(lights.size())), lights.size() - 1);
  }
  if (light < lights.area.size()) return sample_area(lights.area[light].shape, near, v).p;
  light -= lights.area.size();
  if (light < lights.environments.size()) return std::nullopt;
  return std::visit(PositionOf{}, lights.delta[light - lights.environments.size()]);
}

}  // namespace penumbra
