#include "worker/materials/oren_nayar.h"

#include <algorithm>
#include <numbers>

#include "worker/materials/local_frame.h"
#include "worker/sampling/warp.h"

namespace penumbra {

OrenNayar oren_nayar(const Rgb& reflectance, double sigma_degrees) {
  const double sigma = sigma_degrees * (std::numbers::pi / 180);
  const double sigma2 = sigma * sigma;
  return {reflectance, 1 - sigma2 / (2 * (sigma2 + 0.33)), 0.45 * sigma2 / (sigma2 + 0.09)};
}

// f = (R/π) (A + B max(0, cos(φi - φo)) sin α tan β), α the larger and β the smaller of the two angles.
// cos(φi - φo) sin α tan β = (xi xo + yi yo) / cos β: no azimuth is formed, so the pole needs no care.
Rgb f(const OrenNayar& lobe, const Vec3d& wo, const Vec3d& wi) {
  const double planar = wi.x * wo.x + wi.y * wo.y;
  const double cos_beta = std::max(abs_cos(wi), abs_cos(wo));
  const double rough = planar > 0 ? planar / cos_beta : 0;
  return lobe.reflectance * static_cast<float>((lobe.a + lobe.b * rough) * std::numbers::inv_pi);
}

double pdf(const OrenNayar&, const Vec3d& wo, const Vec3d& wi) {
  return same_hemisphere(wo, wi) ? cosine_hemisphere_pdf(abs_cos(wi)) : 0;
}

std::optional<Vec3d> sample(const OrenNayar&, const Vec3d& wo, const Vec2d& u) {
  Vec3d wi = square_to_cosine_hemisphere(u);
  if (wo.z < 0) wi.z = -wi.z;
  return wi;
}

}  // namespace penumbra
