#pragma once
#include <optional>

#include "scenes/math.h"
#include "worker/materials/fresnel.h"
#include "worker/materials/trowbridge_reitz.h"

namespace penumbra {

/// Reflection by facets that are mirrors; Torrance & Sparrow 1967 as in pbrt-v3 §8.4.4.
struct MicrofacetReflection {
  static constexpr bool kSpecular = false, kTransmits = false, kFolds = true;
  Rgb reflectance;
  TrowbridgeReitz facets;
  Fresnel fresnel;
};

Rgb f(const MicrofacetReflection& lobe, const Vec3d& wo, const Vec3d& wi);
double pdf(const MicrofacetReflection& lobe, const Vec3d& wo, const Vec3d& wi);
std::optional<Vec3d> sample(const MicrofacetReflection& lobe, const Vec3d& wo, const Vec2d& u);

/// D G2 / (4 cosθ_i cosθ_o), sr⁻¹: the lobe without colour and Fresnel factor.
double microfacet_reflection_term(const TrowbridgeReitz& facets, const Vec3d& wo, const Vec3d& wi,
                                  const Vec3d& wh);

}  // namespace penumbra
