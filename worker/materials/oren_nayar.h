#pragma once
#include <optional>

#include "scenes/math.h"

namespace penumbra {

/// Rough diffuse reflection, the qualitative model of Oren & Nayar 1994 (pbrt-v3 §8.4.1).
struct OrenNayar {
  static constexpr bool kSpecular = false, kTransmits = false, kFolds = true;
  Rgb reflectance;
  double a = 1, b = 0;
};

/// `sigma_degrees`: standard deviation of the facets' slope angle, [0, 90].
OrenNayar oren_nayar(const Rgb& reflectance, double sigma_degrees);

Rgb f(const OrenNayar& lobe, const Vec3d& wo, const Vec3d& wi);
double pdf(const OrenNayar& lobe, const Vec3d& wo, const Vec3d& wi);
std::optional<Vec3d> sample(const OrenNayar& lobe, const Vec3d& wo, const Vec2d& u);

}  // namespace penumbra
