#pragma once
// Gradient noise (Perlin 2002) and its sums, as pbrt's procedural textures use it. The lattice's gradients
// come from a hash, so the patterns are pbrt's in kind, not in place.
#include "scenes/math.h"

namespace penumbra {

/// Smooth noise in about [-1, 1], 0 at integer points.
float noise(const Vec3f& p);

/// How much detail a sum of octaves has: each is `roughness` times the one before, at 1.99 times its
/// frequency; at most `octaves`, fewer where the footprint is larger than the detail.
struct Octaves {
  int octaves = 8;
  float roughness = 0.5f;
};

/// Fractional Brownian motion: Σ roughnessⁱ noise(1.99ⁱ p).
float fbm(const Vec3f& p, const Vec3f& dpdx, const Vec3f& dpdy, const Octaves& octaves);
/// The same of |noise|: first-derivative creases.
float turbulence(const Vec3f& p, const Vec3f& dpdx, const Vec3f& dpdy, const Octaves& octaves);

}  // namespace penumbra
