// `area`: points uniform on the light's surface, p_A = 1/A (design §4).
#include "worker/strategies/strategy.h"

namespace penumbra {

LightSample sample(const AreaStrategy&, const LightView& view, const Vec2d& u) {
  return towards(view, sample_area(view.area().shape, view.x(), u));
}

double pdf(const AreaStrategy&, const LightView& view, const LightSample& s) {
  return pdf_area(view.area().shape, view.x(), s.at.p, s.at.n);
}

}  // namespace penumbra
