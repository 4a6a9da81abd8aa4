#include "worker/materials/lambert_transmission.h"

#include <numbers>

#include "worker/materials/local_frame.h"
#include "worker/sampling/warp.h"

namespace penumbra {

Rgb f(const LambertTransmission& lobe, const Vec3d&, const Vec3d&) {
  return lobe.transmittance * std::numbers::inv_pi_v<float>;
}

double pdf(const LambertTransmission&, const Vec3d& wo, const Vec3d& wi) {
  return same_hemisphere(wo, wi) ? 0 : cosine_hemisphere_pdf(abs_cos(wi));
}

std::optional<Vec3d> sample(const LambertTransmission&, const Vec3d& wo, const Vec2d& u) {
  Vec3d wi = square_to_cosine_hemisphere(u);
  if (wo.z > 0) wi.z = -wi.z;
  return wi;
}

}  // namespace penumbra
