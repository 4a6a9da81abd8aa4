#include "worker/materials/specular_transmission.h"

#include "worker/materials/fresnel.h"
#include "worker/materials/local_frame.h"

namespace penumbra {

std::optional<SpecularDirection> scatter(const SpecularTransmission& lobe, const Vec3d& wo) {
  const bool above = wo.z > 0;
  const double eta = above ? lobe.eta_above / lobe.eta_below : lobe.eta_below / lobe.eta_above;
  Vec3d wi;
  if (!refracted(wo, Vec3d(0, 0, above ? 1 : -1), eta, wi) || abs_cos(wi) < kLeastCosine) return std::nullopt;
  // Radiance is concentrated by η² where the cone of directions narrows.
  const double throughput = (1 - fresnel_dielectric(wo.z, lobe.eta_above, lobe.eta_below)) * eta * eta;
  return SpecularDirection{wi, lobe.transmittance * static_cast<float>(throughput / abs_cos(wi))};
}

}  // namespace penumbra
