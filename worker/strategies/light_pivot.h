#pragma once
// A place that light comes from, for choosing points of a ray with it in mind.
#include <optional>

#include "worker/strategies/light_set.h"

namespace penumbra {

/// A point of a light at a finite distance, or nothing where there is none. Which light: by its estimated
/// contribution at `near` where lights are drawn, else any with equal chances. The point itself is used for
/// no estimate, so no density is given. `u` chooses the light, `v` its point.
std::optional<Vec3d> light_pivot(const LightSet& lights, const Vec3d& near, double u, const Vec2d& v);

}  // namespace penumbra
