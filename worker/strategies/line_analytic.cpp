// `line-analytic@DEG`: chords as of `line-area@DEG`, the integral along the visible part in closed form
// (Billen & Dutré 2016) for Lambert's lobes.
#include "worker/lights/line_irradiance.h"
#include "worker/strategies/strategy.h"

namespace penumbra {

LightLine choose(const LineAnalyticStrategy& strategy, const LightView&, double u) {
  return strategy.chords.choose(u);
}

LightLine through(const LineAnalyticStrategy& strategy, const LightView&, const Vec3d& p) {
  return strategy.chords.through(p);
}

Rgb closed_form(const LightView& view, const LightLine& line, std::span<const Interval> visible) {
  const ShadingPoint& point = view.point();
  const Vec3d x = view.x(), normal(point.normal), ns(point.bsdf->ns());
  // Visible intervals do not cross the horizon: their middle tells the side.
  double above = 0, below = 0;
  for (const Interval& part : visible) {
    const double middle = 0.5 * (double(part.lo) + part.hi);
    const bool is_above = normal.dot((line.corner - x) + (line.from + middle * line.along)) > 0;
    (is_above ? above : below) += line_irradiance(line, x, ns, part.lo, part.hi);
  }
  // The density of the offset is scale × chord length.
  const double density = line.scale * line.along.length();
  Rgb sum = point.bsdf->lambertian(true) * float(above / density);
  if (below > 0) sum += point.bsdf->lambertian(false) * float(below / density);
  return sum * view.area().radiance;
}

}  // namespace penumbra
