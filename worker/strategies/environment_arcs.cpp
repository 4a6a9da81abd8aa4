// `line-sa@v`, `line-sa@u` on light from infinitely far away: quarters of great circles
// (worker/lights/arc.h), about the map's own poles by the luminance of what lies on them, or down from the
// surface's normal by the cosine. After Nowrouzezahrai et al. 2014.
#include <numbers>

#include "worker/strategies/strategy.h"

namespace penumbra {
namespace {

/// All directions alike, for points without a normal.
const ArcTable& uniform_table() {
  static const ArcTable table(1, 1, {1.0});
  return table;
}

/// Chords end so far outside that the whole scene lies before them: a chord of a quarter comes as near as
/// R/√2.
double radius(const LightView& view) {
  return 2 * double(view.reach());
}

LightLine map_line(const LightView& view, const ArcTable::Meridian& meridian) {
  const Environment& light = view.environment();
  const ArcTable& table = light.arcs();
  ArcMeasure measure{&table, meridian, table.measure(meridian, 0, 1)};
  if (!(measure.total > 0)) return {};
  const double pole = meridian.lower ? -1 : 1;
  return arc_line(view.x(), light.to_world({0, 0, pole}),
                  light.to_world({std::cos(meridian.phi), std::sin(meridian.phi), 0}), radius(view), measure,
                  1 / table.total());
}

/// The surface's normal and two axes across it.
struct Axes {
  Vec3d pole, across, along;
};

Axes axes_of(const ShadingPoint& point) {
  Axes axes;
  axes.pole = point.bsdf != nullptr ? Vec3d(point.normal) : Vec3d(0, 0, 1);
  const Vec3d& n = axes.pole;
  // The axis that the normal has least of.
  const Vec3d least = std::abs(n.x) < std::abs(n.y)
                          ? (std::abs(n.x) < std::abs(n.z) ? Vec3d(1, 0, 0) : Vec3d(0, 0, 1))
                          : (std::abs(n.y) < std::abs(n.z) ? Vec3d(0, 1, 0) : Vec3d(0, 0, 1));
  axes.across = n.cross(least).normalized();
  axes.along = n.cross(axes.across);
  return axes;
}

/// Half a meridian about the normal; the lower half where light from below counts.
LightLine normal_line(const LightView& view, double phi, bool lower) {
  const ShadingPoint& point = view.point();
  const Axes axes = axes_of(point);
  ArcMeasure measure;
  double scale = (point.has_horizon() ? 1 : 0.5) / std::numbers::pi;
  if (point.bsdf == nullptr) {
    measure.table = &uniform_table();
    measure.meridian = {0, lower, phi};
    measure.total = 1;
    scale = 1 / measure.table->total();
  }
  return arc_line(view.x(), lower ? -axes.pole : axes.pole,
                  axes.across * std::cos(phi) + axes.along * std::sin(phi), radius(view), measure, scale);
}

}  // namespace

LightLine choose(const MapArcStrategy&, const LightView& view, double u) {
  return map_line(view, view.environment().arcs().choose(u));
}

LightLine through(const MapArcStrategy&, const LightView& view, const Vec3d& p) {
  const Vec3d w = view.environment().to_local(p - view.x());
  return map_line(view, view.environment().arcs().through(w));
}

LightLine choose(const NormalArcStrategy&, const LightView& view, double u) {
  const bool both = !view.point().has_horizon(), lower = both && u >= 0.5;
  if (both) u = lower ? 2 * u - 1 : 2 * u;
  return normal_line(view, 2 * std::numbers::pi * u, lower);
}

LightLine through(const NormalArcStrategy&, const LightView& view, const Vec3d& p) {
  const Axes axes = axes_of(view.point());
  const Vec3d w = p - view.x();
  const bool lower = w.dot(axes.pole) < 0;
  if (lower && view.point().has_horizon()) return {};
  return normal_line(view, std::atan2(w.dot(axes.along), w.dot(axes.across)), lower);
}

LightSample towards_sky(const LightView& view, const LightLine& line, double s, const LightPoint& at) {
  LightSample out;
  out.at = at;
  if (!std::holds_alternative<ArcMeasure>(line.measure)) {
    out.wi = Vec3f((at.p - view.x()).normalized());
    out.radiance = view.environment().radiance(out.wi);
    return out;
  }
  out.wi = Vec3f((line.from + s * line.along).normalized());
  const auto& measure = std::get<ArcMeasure>(line.measure);
  const bool own = measure.table != nullptr && measure.table != &uniform_table();
  out.radiance = own ? view.environment().radiance(measure.meridian.column,
                                                   measure.table->row_at(measure.meridian, s), out.wi)
                     : view.environment().radiance(out.wi);
  return out;
}

}  // namespace penumbra
