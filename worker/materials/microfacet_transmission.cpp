#include "worker/materials/microfacet_transmission.h"

#include "worker/materials/fresnel.h"
#include "worker/materials/local_frame.h"

namespace penumbra {
namespace {

/// η of wi's side relative to wo's.
double relative_eta(const MicrofacetTransmission& lobe, const Vec3d& wo) {
  return wo.z > 0 ? lobe.eta_below / lobe.eta_above : lobe.eta_above / lobe.eta_below;
}

/// The facet that refracts wo into wi, and what its cosines are.
struct Facet {
  Vec3d wh;  ///< unit, on the side of the shading normal
  double cos_o, cos_i, denominator;
};

/// Empty where no facet can: both directions on one side of the surface or of the facet, or a facet that
/// wo would see from behind.
std::optional<Facet> refracting_facet(const Vec3d& wo, const Vec3d& wi, double eta) {
  if (same_hemisphere(wo, wi)) return std::nullopt;
  const Vec3d sum = wo + wi * eta;
  if (sum == Vec3d(0)) return std::nullopt;  // equal indices, straight on: every facet and none
  Vec3d wh = sum.normalized();
  if (wh.z < 0) wh = -wh;
  const double cos_o = wo ^ wh, cos_i = wi ^ wh;
  if (cos_o * cos_i >= 0 || cos_o * wo.z <= 0) return std::nullopt;
  return Facet{wh, cos_o, cos_i, cos_o + eta * cos_i};
}

}  // namespace

// Walter et al. 2007, eq. 21, times 1/η² for radiance.
Rgb f(const MicrofacetTransmission& lobe, const Vec3d& wo, const Vec3d& wi) {
  const double eta = relative_eta(lobe, wo);
  const auto facet = refracting_facet(wo, wi, eta);
  if (!facet) return Rgb(0);
  const double fresnel = fresnel_dielectric(facet->cos_o, lobe.eta_above, lobe.eta_below);
  const double term = distribution(lobe.facets, facet->wh) * masking_shadowing(lobe.facets, wo, wi) *
                      std::abs(facet->cos_i * facet->cos_o) /
                      (abs_cos(wi) * abs_cos(wo) * facet->denominator * facet->denominator);
  return lobe.transmittance * static_cast<float>((1 - fresnel) * term);
}

// Walter et al. 2007, eq. 17: dωh/dωi = η² |wi·wh| / (wo·wh + η wi·wh)².
double pdf(const MicrofacetTransmission& lobe, const Vec3d& wo, const Vec3d& wi) {
  const double eta = relative_eta(lobe, wo);
  const auto facet = refracting_facet(wo, wi, eta);
  if (!facet) return 0;
  const double jacobian = eta * eta * std::abs(facet->cos_i) / (facet->denominator * facet->denominator);
  return visible_normal_pdf(lobe.facets, wo, facet->wh) * jacobian;
}

std::optional<Vec3d> sample(const MicrofacetTransmission& lobe, const Vec3d& wo, const Vec2d& u) {
  const Vec3d wh = sample_visible_normal(lobe.facets, wo, u);
  Vec3d wi;
  if (!refracted(wo, wh, 1 / relative_eta(lobe, wo), wi) || same_hemisphere(wo, wi)) return std::nullopt;
  return wi;
}

}  // namespace penumbra
