// `bsdf`: directions from the material's lobes. Its samples serve every light at once, so they are
// traced once per shading point by the loop in direct_light.cpp; here is their density.
#include "worker/strategies/strategy.h"

namespace penumbra {

double pdf(const BsdfStrategy&, const LightView& view, const LightSample& s) {
  return view.point().scattering.pdf(view.point().wo, s.wi);
}

}  // namespace penumbra
