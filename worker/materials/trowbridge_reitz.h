#pragma once
// The GGX microfacet distribution of Trowbridge & Reitz 1975 / Walter et al. 2007, anisotropic, with the
// height-correlated Smith masking of pbrt-v3 §8.4 and sampling of visible normals (Heitz 2018).
#include "scenes/math.h"

namespace penumbra {

struct TrowbridgeReitz {
  /// Below this the lobe is narrower than directions in single precision resolve: at θ ≈ α the relative
  /// error of D is 4 δ/α, with δ ≈ 2⁻²⁴ 2e-4 here. It is also pbrt's bound.
  static constexpr double kLeastAlpha = 1e-3;

  double alpha_x = 0.1, alpha_y = 0.1;
};

/// Differential area of facets with normal wh, per unit area and sr⁻¹; even in wh.
double distribution(const TrowbridgeReitz& d, const Vec3d& wh);
/// Smith's Λ(w), w.z != 0.
double lambda(const TrowbridgeReitz& d, const Vec3d& w);
/// Masking of one direction, 1/(1 + Λ).
double masking(const TrowbridgeReitz& d, const Vec3d& w);
/// Joint masking and shadowing, 1/(1 + Λ(wo) + Λ(wi)).
double masking_shadowing(const TrowbridgeReitz& d, const Vec3d& wo, const Vec3d& wi);

/// A facet normal visible from wo, on wo's side.
Vec3d sample_visible_normal(const TrowbridgeReitz& d, const Vec3d& wo, const Vec2d& u);
/// Density of sample_visible_normal() at wh (on wo's side and visible), sr⁻¹.
double visible_normal_pdf(const TrowbridgeReitz& d, const Vec3d& wo, const Vec3d& wh);

/// pbrt-v3's α of a perceptual roughness: a quartic in log(roughness), fitted by eye. Below 1e-3 constant.
double alpha_of_roughness_v3(double roughness);
/// pbrt-v4's: √roughness.
double alpha_of_roughness_v4(double roughness);

}  // namespace penumbra
