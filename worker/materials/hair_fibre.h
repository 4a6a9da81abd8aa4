#pragma once
// Light scattered by one hair: Chiang, Bitterli, Tappan & Burley 2016, *A practical and controllable hair and
// fur model for production path tracing*, after Marschner et al. 2003 and d'Eon et al. 2011; notation as in
// Pharr 2016, *The implementation of a hair scattering model*.
//
// Frame: x along the hair, θ from the plane across it (sinθ = x), φ = atan2(z, y) about it. Light is
// reflected (p = 0), goes through (1), is reflected once within (2) or more often (3, the rest): S = Σ A_p
// M_p(θ_o, θ_i) N_p(φ_i - φ_o). ∫ S dω = Σ A_p, which is 1 for a hair that absorbs nothing.
#include <array>
#include <optional>

#include "scenes/math.h"

namespace penumbra {

/// A hair has no horizon and no cosine: f is S / |cosθ| of the shading normal, so that f × cosine is S.
struct HairFibre {
  static constexpr bool kSpecular = false, kTransmits = true, kFolds = false;
  Vec3f sigma_a;                     ///< absorption, per radius of the hair
  float h = 0;                       ///< where it was hit: offset from its axis, in [-1,1] radii
  float eta = 1.55f;                 ///< index inside, at least 1
  float variance = 0;                ///< of M_0
  float scale = 0;                   ///< of the logistic distribution of N_p
  float sin_tilt = 0, cos_tilt = 1;  ///< of the cuticle's scales
};

/// Roughness along (beta_m) and about the hair (beta_n) in [0,1]; tilt in degrees. Below 1e-3 a roughness is
/// taken as that, as facets' is (trowbridge_reitz.h).
HairFibre hair_fibre(const Vec3f& sigma_a, double h, double eta, double beta_m, double beta_n, double tilt);

Rgb f(const HairFibre& hair, const Vec3d& wo, const Vec3d& wi);
double pdf(const HairFibre& hair, const Vec3d& wo, const Vec3d& wi);
/// Takes three numbers: which p and how far from its cone by u.x, about the hair by u.y, about the cone by
/// `choice`.
std::optional<Vec3d> sample(const HairFibre& hair, const Vec3d& wo, const Vec2d& u, double choice);

/// Absorption that gives a hair of roughness beta_n about this colour (Chiang et al. 2016, §4.2).
Vec3f hair_absorption_of(const Rgb& color, double beta_n);
/// Of melanin's two kinds by concentration (d'Eon et al. 2011).
Vec3f hair_absorption_of_melanin(double eumelanin, double pheomelanin);

/// M: density over sinθ_i about θ_i = -θ_o; ∫ M cosθ dθ = 1.
double hair_longitudinal(double sin_i, double cos_i, double sin_o, double cos_o, double variance);
/// The logistic density on [-π,π] and its inverse.
double hair_azimuthal(double x, double scale);
double sample_hair_azimuthal(double u, double scale);

}  // namespace penumbra
