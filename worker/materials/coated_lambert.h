#pragma once
#include <optional>

#include "scenes/math.h"

namespace penumbra {

/// A diffuse base under a smooth dielectric coat, all orders of reflection between them summed in closed
/// form. Only what leaves through the coat: what the coat itself reflects is another lobe's.
struct CoatedLambert {
  static constexpr bool kSpecular = false, kTransmits = false, kFolds = true;
  Rgb reflectance;          ///< of the base
  double eta = 1.5;         ///< of the coat, > 1
  double internal = 0.596;  ///< diffuse reflectance of the coat from below
};

/// With `internal` derived from eta.
CoatedLambert coated_lambert(const Rgb& reflectance, double eta);

Rgb f(const CoatedLambert& lobe, const Vec3d& wo, const Vec3d& wi);
double pdf(const CoatedLambert& lobe, const Vec3d& wo, const Vec3d& wi);
std::optional<Vec3d> sample(const CoatedLambert& lobe, const Vec3d& wo, const Vec2d& u);

}  // namespace penumbra
