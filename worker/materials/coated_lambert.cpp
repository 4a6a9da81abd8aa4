#include "worker/materials/coated_lambert.h"

#include <numbers>

#include "worker/materials/fresnel.h"
#include "worker/materials/local_frame.h"
#include "worker/sampling/warp.h"

namespace penumbra {

// By reciprocity the diffuse transmittance is the same both ways up to the η² of the cone's compression:
// 1 - internal = (1 - external) / η².
CoatedLambert coated_lambert(const Rgb& reflectance, double eta) {
  return {reflectance, eta, 1 - (1 - fresnel_diffuse_reflectance(eta)) / (eta * eta)};
}

// Light enters with 1 - F(θi), is scattered by the base ρ/π, leaves with 1 - F(θo) spread over η² more
// solid angle, and what is held back returns to the base: the geometric series 1/(1 - ρ F_internal).
Rgb f(const CoatedLambert& lobe, const Vec3d& wo, const Vec3d& wi) {
  const double through =
      (1 - fresnel_dielectric(abs_cos(wi), 1, lobe.eta)) * (1 - fresnel_dielectric(abs_cos(wo), 1, lobe.eta));
  const double scale = through / (std::numbers::pi * lobe.eta * lobe.eta);
  const Rgb held = Rgb(1) - lobe.reflectance * static_cast<float>(lobe.internal);
  return lobe.reflectance / held * static_cast<float>(scale);
}

double pdf(const CoatedLambert&, const Vec3d& wo, const Vec3d& wi) {
  return same_hemisphere(wo, wi) ? cosine_hemisphere_pdf(abs_cos(wi)) : 0;
}

std::optional<Vec3d> sample(const CoatedLambert&, const Vec3d& wo, const Vec2d& u) {
  Vec3d wi = square_to_cosine_hemisphere(u);
  if (wo.z < 0) wi.z = -wi.z;
  return wi;
}

}  // namespace penumbra
