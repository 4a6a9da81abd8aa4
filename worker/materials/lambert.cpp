#include "worker/materials/lambert.h"

#include <numbers>

#include "worker/materials/local_frame.h"
#include "worker/sampling/warp.h"

namespace penumbra {

Rgb f(const Lambert& lobe, const Vec3d&, const Vec3d&) {
  return lobe.reflectance * std::numbers::inv_pi_v<float>;
}

double pdf(const Lambert&, const Vec3d& wo, const Vec3d& wi) {
  return same_hemisphere(wo, wi) ? cosine_hemisphere_pdf(abs_cos(wi)) : 0;
}

std::optional<Vec3d> sample(const Lambert&, const Vec3d& wo, const Vec2d& u) {
  Vec3d wi = square_to_cosine_hemisphere(u);
  if (wo.z < 0) wi.z = -wi.z;
  return wi;
}

}  // namespace penumbra
