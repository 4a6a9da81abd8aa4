#include "worker/strategies/strategy.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "proto/status.h"
#include "worker/strategies/light_sight.h"

namespace penumbra {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

/// Angle from edge u to edge v of a light, in its plane: where `line-sa@v` runs on a light that has no
/// spherical rectangle.
double second_edge_angle(const LightShape& shape) {
  Vec3d u(1, 0, 0), v(0, 1, 0);
  if (const auto* quad = std::get_if<QuadShape>(&shape)) {
    u = Vec3d(quad->u);
    v = Vec3d(quad->v);
  } else if (const auto* triangle = std::get_if<TriangleShape>(&shape)) {
    u = Vec3d(triangle->p1) - Vec3d(triangle->p0);
    v = Vec3d(triangle->p2) - Vec3d(triangle->p0);
  }
  return std::atan2(u.cross(v).length(), u.dot(v));
}

Strategy fit_point(const LightShape& shape) {
  const bool spherical = std::holds_alternative<QuadShape>(shape) ||
                         std::holds_alternative<TriangleShape>(shape) ||
                         std::holds_alternative<SphereShape>(shape);
  if (spherical) return SolidAngleStrategy{};
  return AreaStrategy{};
}

/// What polygon_of() (light_sight.h) knows.
bool is_polygon(const LightShape& shape) {
  return std::holds_alternative<QuadShape>(shape) || std::holds_alternative<TriangleShape>(shape);
}

template <class Lines = LineAreaStrategy>
Strategy fit_line_area(double radians, const LightShape& shape) {
  if (has_line_area(shape)) return Lines{radians, ParallelChords(shape, radians)};
  return fit_point(shape);
}

Strategy fit_line_solid_angle(bool along_u, const LightShape& shape) {
  if (has_line_solid_angle(shape)) return LineSolidAngleStrategy{along_u};
  return fit_line_area(along_u ? 0 : second_edge_angle(shape), shape);
}

}  // namespace

Strategy fit(const StrategyCount& wanted, const AreaEmitter& emitter) {
  const LightShape& shape = emitter.shape;
  switch (wanted.kind) {
    case StrategyKind::kBsdf:
      return emitter.invisible ? fit_point(shape) : Strategy{BsdfStrategy{}};
    case StrategyKind::kArea:
      return AreaStrategy{};
    case StrategyKind::kSolidAngle:
      return fit_point(shape);
    case StrategyKind::kVisibleArea:
      return is_polygon(shape) ? Strategy{VisibleAreaStrategy{}} : fit_point(shape);
    case StrategyKind::kLineArea:
      return fit_line_area(wanted.angle_degrees * kDegree, shape);
    case StrategyKind::kLineSolidAngleU:
      return fit_line_solid_angle(true, shape);
    case StrategyKind::kLineSolidAngleV:
      return fit_line_solid_angle(false, shape);
    case StrategyKind::kLineUniform:
      return fit_line_area<LineUniformStrategy>(wanted.angle_degrees * kDegree, shape);
    case StrategyKind::kLineAnalytic:
      return fit_line_area<LineAnalyticStrategy>(wanted.angle_degrees * kDegree, shape);
  }
  PENUMBRA_CHECK(false);
}

StrategyCount in_company(const StrategyCount& wanted, const Mix& mix) {
  StrategyCount out = wanted;
  const bool weighs = mix.strategies.size() > 1 && mix.combination != Combination::kAverage;
  if (weighs && wanted.kind == StrategyKind::kLineAnalytic) out.kind = StrategyKind::kLineArea;
  return out;
}

Strategy fit_environment(const StrategyCount& wanted, const Environment& environment, bool lines) {
  if (wanted.kind == StrategyKind::kBsdf) return BsdfStrategy{};
  if (environment.portal() != nullptr) {
    const bool along_u = wanted.kind == StrategyKind::kLineSolidAngleU;
    if (along_u || wanted.kind == StrategyKind::kLineSolidAngleV) return PortalChordStrategy{along_u};
    return PortalStrategy{};
  }
  if (lines && wanted.kind == StrategyKind::kLineSolidAngleU) return NormalArcStrategy{};
  if (lines && wanted.kind == StrategyKind::kLineSolidAngleV && environment.has_arcs())
    return MapArcStrategy{};
  return EnvironmentStrategy{};
}

std::string name_of(const Strategy& strategy) {
  struct Name {
    std::string operator()(const BsdfStrategy&) const { return "bsdf"; }
    std::string operator()(const AreaStrategy&) const { return "area"; }
    std::string operator()(const SolidAngleStrategy&) const { return "sa"; }
    std::string operator()(const VisibleAreaStrategy&) const { return "visible-area"; }
    std::string operator()(const EnvironmentStrategy&) const { return "its own luminance"; }
    std::string operator()(const MapArcStrategy&) const { return "line-sa@v"; }
    std::string operator()(const NormalArcStrategy&) const { return "line-sa@u"; }
    std::string operator()(const PortalStrategy&) const { return "sa"; }
    std::string operator()(const PortalChordStrategy& s) const {
      return s.along_u ? "line-sa@u" : "line-sa@v";
    }
    std::string operator()(const LineAreaStrategy& s) const {
      return fmt::format("line-area@{:g}", s.radians / kDegree);
    }
    std::string operator()(const LineUniformStrategy& s) const {
      return fmt::format("line-uniform@{:g}", s.radians / kDegree);
    }
    std::string operator()(const LineAnalyticStrategy& s) const {
      return fmt::format("line-analytic@{:g}", s.radians / kDegree);
    }
    std::string operator()(const LineSolidAngleStrategy& s) const {
      return s.along_u ? "line-sa@u" : "line-sa@v";
    }
  };
  return std::visit(Name{}, strategy);
}

bool is_line(const Strategy& strategy) {
  return std::visit(
      [](const auto& s) {
        return requires(const LightView& view) {
          choose(s, view, 0.0);
        };
      },
      strategy);
}

bool is_analytic(const Strategy& strategy) {
  return std::holds_alternative<LineAnalyticStrategy>(strategy);
}

bool is_bsdf(const Strategy& strategy) {
  return std::holds_alternative<BsdfStrategy>(strategy);
}

bool wants_region(const Strategy& strategy) {
  return std::holds_alternative<VisibleAreaStrategy>(strategy);
}

const VisibleRegion* LightView::region() const {
  return sight_ != nullptr ? sight_->region() : nullptr;
}

LightSample sample_point(const Strategy& strategy, const LightView& view, const Vec2d& u) {
  return std::visit(
      [&](const auto& s) -> LightSample {
        if constexpr (requires { sample(s, view, u); }) return sample(s, view, u);
        return {};
      },
      strategy);
}

double density_of(const Strategy& strategy, const LightView& view, const LightSample& at) {
  return std::visit(
      [&](const auto& s) -> double {
        if constexpr (requires { pdf(s, view, at); }) return pdf(s, view, at);
        return 0;
      },
      strategy);
}

LightLine choose_line(const Strategy& strategy, const LightView& view, double u) {
  return std::visit(
      [&](const auto& s) -> LightLine {
        if constexpr (requires { choose(s, view, u); }) return choose(s, view, u);
        return {};
      },
      strategy);
}

LightLine line_through(const Strategy& strategy, const LightView& view, const Vec3d& p) {
  return std::visit(
      [&](const auto& s) -> LightLine {
        if constexpr (requires { through(s, view, p); }) return through(s, view, p);
        return {};
      },
      strategy);
}

LightSample towards(const LightView& view, const LightPoint& at) {
  LightSample s;
  s.at = at;
  const Vec3d d = at.p - view.x();
  const double distance = d.length();
  if (!(distance > 0)) {  // the shading point lies on the light: no direction
    s.at.pdf = 0;
    return s;
  }
  s.wi = Vec3f(d / distance);
  s.radiance = view.area().radiance;
  return s;
}

}  // namespace penumbra
