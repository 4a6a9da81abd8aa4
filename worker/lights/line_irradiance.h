#pragma once
// Irradiance along a chord of a flat light in closed form: the diffuse line integral of Billen & Dutré 2016.
#include "worker/lights/line.h"

namespace penumbra {

/// ∫ |n·ω| cosθ_l / r² dl over the part [lo,hi] of the line, l its length and ω the direction from x: what
/// the line adds, per length across it, to the irradiance at x from a light of radiance 1. In 1/length; 0 for
/// a line seen from behind. n: unit.
double line_irradiance(const LightLine& line, const Vec3d& x, const Vec3d& n, double lo, double hi);

}  // namespace penumbra
