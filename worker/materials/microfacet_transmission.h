#pragma once
#include <optional>

#include "scenes/math.h"
#include "worker/materials/trowbridge_reitz.h"

namespace penumbra {

/// Refraction by rough facets; Walter et al. 2007 as in pbrt-v3 §8.4.4, for radiance.
struct MicrofacetTransmission {
  static constexpr bool kSpecular = false, kTransmits = true, kFolds = false;
  Rgb transmittance;
  TrowbridgeReitz facets;
  double eta_above = 1, eta_below = 1.5;  ///< index on the side of the normal, and on the other
};

Rgb f(const MicrofacetTransmission& lobe, const Vec3d& wo, const Vec3d& wi);
double pdf(const MicrofacetTransmission& lobe, const Vec3d& wo, const Vec3d& wi);
std::optional<Vec3d> sample(const MicrofacetTransmission& lobe, const Vec3d& wo, const Vec2d& u);

}  // namespace penumbra
