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

namespace {

/// Of what is above the horizon, and below.
struct Sides {
  double above = 0, below = 0;
};

/// [lo,hi] does not cross the horizon: its middle tells the side.
void add(Sides& sides, const LightView& view, const LightLine& line, double lo, double hi) {
  const ShadingPoint& point = view.point();
  const Vec3d x = view.x(), normal(point.normal), ns(point.bsdf->ns());
  const bool is_above = normal.dot((line.corner - x) + (line.from + 0.5 * (lo + hi) * line.along)) > 0;
  (is_above ? sides.above : sides.below) += line_irradiance(line, x, ns, lo, hi);
}

Rgb scattered(const LightView& view, const LightLine& line, const Sides& sides) {
  const ShadingPoint& point = view.point();
  // The density of the offset is scale × chord length.
  const double density = line.scale * line.along.length();
  Rgb sum = point.bsdf->lambertian(true) * float(sides.above / density);
  if (sides.below > 0) sum += point.bsdf->lambertian(false) * float(sides.below / density);
  return sum * view.area().radiance;
}

}  // namespace

Rgb closed_form(const LightView& view, const LightLine& line, std::span<const Interval> visible) {
  Sides sides;
  for (const Interval& part : visible) add(sides, view, line, part.lo, part.hi);
  return scattered(view, line, sides);
}

Rgb closed_form(const LightView& view, const LightLine& line, double lo, double hi) {
  Sides sides;
  add(sides, view, line, lo, hi);
  return scattered(view, line, sides);
}

}  // namespace penumbra
