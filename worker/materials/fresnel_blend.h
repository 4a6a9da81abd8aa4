#pragma once
#include <optional>

#include "scenes/math.h"
#include "worker/materials/trowbridge_reitz.h"

namespace penumbra {

/// A glossy coat over a diffuse base; Ashikhmin & Shirley 2000 as in pbrt-v3 §8.5.
struct FresnelBlend {
  static constexpr bool kSpecular = false, kTransmits = false, kFolds = true;
  Rgb diffuse, specular;  ///< specular: reflectance at normal incidence
  TrowbridgeReitz facets;
};

Rgb f(const FresnelBlend& lobe, const Vec3d& wo, const Vec3d& wi);
double pdf(const FresnelBlend& lobe, const Vec3d& wo, const Vec3d& wi);
std::optional<Vec3d> sample(const FresnelBlend& lobe, const Vec3d& wo, const Vec2d& u);

}  // namespace penumbra
