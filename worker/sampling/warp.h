#pragma once
// Warps of the unit square, each beside its density.
#include "scenes/math.h"

namespace penumbra {

Vec2d square_to_disk_concentric(const Vec2d& u);    ///< unit disk; density 1/π per area
Vec3d square_to_cosine_hemisphere(const Vec2d& u);  ///< +z; density cosθ/π, sr⁻¹
double cosine_hemisphere_pdf(double cos_theta);
Vec3d square_to_sphere(const Vec2d& u);  ///< density 1/4π, sr⁻¹
/// Cone around +z; takes 1 − cosθ_max, which keeps its digits for narrow cones. Density 1/(2π(1−cosθ_max)).
Vec3d square_to_cone(const Vec2d& u, double one_minus_cos_max);
double cone_pdf(double one_minus_cos_max);
Vec2d square_to_triangle(const Vec2d& u);  ///< barycentric (b1, b2), uniform (Heitz 2019 or the root)

/// Two unit vectors that make a right-handed frame with unit n (Duff et al. 2017).
void frame(const Vec3d& n, Vec3d& s, Vec3d& t);

}  // namespace penumbra
