#pragma once
#include <optional>

#include "scenes/math.h"
#include "worker/materials/specular_reflection.h"

namespace penumbra {

/// Refraction at a smooth interface of two dielectrics, for radiance; pbrt-v3 §8.2.3. Equal indices: the
/// ray goes straight on (opacity).
struct SpecularTransmission {
  static constexpr bool kSpecular = true, kTransmits = true, kFolds = false;
  Rgb transmittance;
  double eta_above = 1, eta_below = 1.5;  ///< index on the side of the normal, and on the other
};

/// Empty in total internal reflection.
std::optional<SpecularDirection> scatter(const SpecularTransmission& lobe, const Vec3d& wo);

}  // namespace penumbra
