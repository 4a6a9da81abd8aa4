#include "worker/materials/microfacet_reflection.h"

#include "worker/materials/local_frame.h"

namespace penumbra {

double microfacet_reflection_term(const TrowbridgeReitz& facets, const Vec3d& wo, const Vec3d& wi,
                                  const Vec3d& wh) {
  return distribution(facets, wh) * masking_shadowing(facets, wo, wi) / (4 * abs_cos(wi) * abs_cos(wo));
}

Rgb f(const MicrofacetReflection& lobe, const Vec3d& wo, const Vec3d& wi) {
  const Vec3d wh = (wi + wo).normalized();
  const double term = microfacet_reflection_term(lobe.facets, wo, wi, wh);
  return lobe.reflectance * reflectance(lobe.fresnel, wi ^ wh) * static_cast<float>(term);
}

// |dωh/dωi| = 1/(4 wo·wh) cancels the wo·wh of the visible normals' density.
double pdf(const MicrofacetReflection& lobe, const Vec3d& wo, const Vec3d& wi) {
  if (!same_hemisphere(wo, wi)) return 0;
  const Vec3d wh = (wo + wi).normalized();
  return distribution(lobe.facets, wh) * masking(lobe.facets, wo) / (4 * abs_cos(wo));
}

std::optional<Vec3d> sample(const MicrofacetReflection& lobe, const Vec3d& wo, const Vec2d& u) {
  const Vec3d wi = reflected(wo, sample_visible_normal(lobe.facets, wo, u));
  if (!same_hemisphere(wo, wi)) return std::nullopt;
  return wi;
}

}  // namespace penumbra
