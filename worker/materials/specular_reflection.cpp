#include "worker/materials/specular_reflection.h"

#include "worker/materials/local_frame.h"

namespace penumbra {

std::optional<SpecularDirection> scatter(const SpecularReflection& lobe, const Vec3d& wo) {
  const Vec3d wi(-wo.x, -wo.y, wo.z);
  const Rgb throughput = lobe.reflectance * reflectance(lobe.fresnel, wi.z);
  return SpecularDirection{wi, throughput * static_cast<float>(1 / abs_cos(wi))};
}

}  // namespace penumbra
