#pragma once
#include <optional>

#include "scenes/math.h"
#include "worker/materials/fresnel.h"

namespace penumbra {

/// What a specular lobe makes of wo: one direction, and f such that f |cosθ_i| is the throughput.
struct SpecularDirection {
  Vec3d wi;
  Rgb f;
};

/// A mirror; pbrt-v3 §8.2.2.
struct SpecularReflection {
  static constexpr bool kSpecular = true, kTransmits = false, kFolds = false;
  Rgb reflectance;
  Fresnel fresnel;
};

std::optional<SpecularDirection> scatter(const SpecularReflection& lobe, const Vec3d& wo);

}  // namespace penumbra
