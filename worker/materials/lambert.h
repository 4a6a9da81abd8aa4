#pragma once
#include <optional>

#include "scenes/math.h"

namespace penumbra {

/// Reflects equally into all directions; pbrt-v3 §8.3.
struct Lambert {
  static constexpr bool kSpecular = false, kTransmits = false, kFolds = true;
  Rgb reflectance;
};

Rgb f(const Lambert& lobe, const Vec3d& wo, const Vec3d& wi);
double pdf(const Lambert& lobe, const Vec3d& wo, const Vec3d& wi);
std::optional<Vec3d> sample(const Lambert& lobe, const Vec3d& wo, const Vec2d& u);

}  // namespace penumbra
