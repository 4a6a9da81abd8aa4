#pragma once
#include <optional>

#include "scenes/math.h"

namespace penumbra {

/// Transmits equally into all directions of the far side; pbrt-v3 §8.3.
struct LambertTransmission {
  static constexpr bool kSpecular = false, kTransmits = true, kFolds = true;
  Rgb transmittance;
};

Rgb f(const LambertTransmission& lobe, const Vec3d& wo, const Vec3d& wi);
double pdf(const LambertTransmission& lobe, const Vec3d& wo, const Vec3d& wi);
std::optional<Vec3d> sample(const LambertTransmission& lobe, const Vec3d& wo, const Vec2d& u);

}  // namespace penumbra
