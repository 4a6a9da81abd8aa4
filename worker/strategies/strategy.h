#pragma once
// The closed set of strategies. A new one needs: a file of its own with its struct, its name in the
// variant, its row in fit(), and either sample()/pdf() overloads (points) or choose()/through()
// overloads (lines). The loop in direct_light.cpp knows none of them by name.
#include <optional>
#include <span>
#include <string>
#include <variant>

#include "proto/mix.h"
#include "worker/effects/environment.h"
#include "worker/lights/chords.h"
#include "worker/lights/emitter.h"
#include "worker/lights/line.h"
#include "worker/lights/shape.h"
#include "worker/lights/visible_region.h"
#include "worker/strategies/shading_point.h"

namespace penumbra {

class LightSight;

/// `bsdf`: the direction comes from the material; the point is what the traced ray meets.
struct BsdfStrategy {};
/// `area`: uniform on the surface.
struct AreaStrategy {};
/// `sa`: uniform in the solid angle of the shape.
struct SolidAngleStrategy {};
/// `visible-area`: uniform in the solid angle of what is visible of a flat light (LightView::region). Where
/// that is not known it is `sa`.
struct VisibleAreaStrategy {};
/// The environment's own sampling by luminance; stands for `area`, `sa` and lines there.
struct EnvironmentStrategy {};
/// `line-sa@v` on light from infinitely far away: quarters of the map's meridians, drawn by their luminance,
/// and by that of their texels on what is visible of them.
struct MapArcStrategy {};
/// `line-sa@u` there: quarters of great circles from the surface's normal to its horizon, by the cosine.
struct NormalArcStrategy {};
/// `sa` on light that comes through a portal (worker/effects/portal.h): by what is behind it, or uniform in
/// its solid angle; stands for `area` and other lines there.
struct PortalStrategy {};
/// `line-sa@u`, `line-sa@v` there: the portal's chords, uniform in solid angle.
struct PortalChordStrategy {
  bool along_u = true;
};
/// `line-area@DEG`. The chords do not depend on the shading point: they are made once per light.
struct LineAreaStrategy {
  double radians = 0;
  ParallelChords chords;
};
/// `line-uniform@DEG`: the same lines, spread evenly across the light.
struct LineUniformStrategy {
  double radians = 0;
  ParallelChords chords;
};
/// `line-analytic@DEG`: the same lines; what Lambert's lobes make of one is integrated in closed form
/// (closed_form()), the rest of the material's from a point on it.
struct LineAnalyticStrategy {
  double radians = 0;
  ParallelChords chords;
};
/// `line-sa@u`, `line-sa@v`.
struct LineSolidAngleStrategy {
  bool along_u = true;
};

using Strategy =
    std::variant<BsdfStrategy, AreaStrategy, SolidAngleStrategy, VisibleAreaStrategy, EnvironmentStrategy,
                 LineAreaStrategy, LineUniformStrategy, LineAnalyticStrategy, LineSolidAngleStrategy,
                 MapArcStrategy, NormalArcStrategy, PortalStrategy, PortalChordStrategy>;

/// What a mix's strategy is in the company of the others: itself, but for `line-analytic`. A line as a whole
/// has no density at a point, so weights of a point cannot know it: where they are asked for, it is
/// `line-area`. It is itself alone and in `/average`.
StrategyCount in_company(const StrategyCount& wanted, const Mix& mix);
/// What a mix's strategy becomes on a light of this shape: itself, or the nearest that fits.
Strategy fit(const StrategyCount& wanted, const AreaEmitter& emitter);
/// On light from infinitely far away; `lines`: may `line-sa` draw lines all around? (Through a portal it
/// may.)
Strategy fit_environment(const StrategyCount& wanted, const Environment& environment, bool lines);
/// `sa`, for messages: the strategy in the words of the mix grammar.
std::string name_of(const Strategy& strategy);
bool is_line(const Strategy& strategy);
bool is_bsdf(const Strategy& strategy);
/// Does it ask for LightView::region()?
bool wants_region(const Strategy& strategy);
/// Does closed_form() give a part of what a line scatters, so that its points are for the rest alone?
bool is_analytic(const Strategy& strategy);

/// One light as it is seen from one shading point; what strategies share is made once, when first asked.
class LightView {
 public:
  /// `sight`: what is known of the light's visibility while it is asked; null: nothing.
  LightView(const ShadingPoint& point, const AreaEmitter& emitter, const LightSight* sight = nullptr)
      : point_(&point), area_(&emitter), sight_(sight) {}
  /// `reach`: from x, past everything (LightSet).
  LightView(const ShadingPoint& point, const Environment& environment, float reach)
      : point_(&point), environment_(&environment), reach_(reach) {}

  const ShadingPoint& point() const { return *point_; }
  const AreaEmitter& area() const { return *area_; }
  const AreaEmitter* emitter() const { return area_; }  ///< null: an environment
  const Environment& environment() const { return *environment_; }
  bool is_area() const { return area_ != nullptr; }
  float reach() const { return reach_; }
  /// Where a direction of the environment is, as a point: past everything.
  Vec3d far_along(const Vec3f& wi) const {
    const bool whole = environment_->portal() == nullptr;
    return x() + Vec3d(wi) * (whole ? double(reach_) : portal().distance_to(Vec3d(wi), portal_far()));
  }
  /// The environment's portal, which it must have, and how far from x the plane is on which its lines lie.
  const SeenPortal& portal() const {
    if (!portal_) portal_.emplace(*environment_->portal(), x());
    return *portal_;
  }
  double portal_far() const { return 2 * double(reach_); }
  Vec3d x() const { return Vec3d(point_->above); }
  const SeenShape& seen() const {
    if (!seen_) seen_.emplace(area_->shape, x());
    return *seen_;
  }
  /// What is visible of the light; null where that is not known (or no strategy wants to know).
  const VisibleRegion* region() const;

 private:
  const ShadingPoint* point_;
  const AreaEmitter* area_ = nullptr;
  const Environment* environment_ = nullptr;
  float reach_ = 0;
  const LightSight* sight_ = nullptr;
  mutable std::optional<SeenShape> seen_;
  mutable std::optional<SeenPortal> portal_;
};

/// A direction towards a light.
struct LightSample {
  Vec3f wi{0};
  LightPoint at{Vec3d(0), Vec3d(0),
                0};  ///< where (or far_along()); its pdf is the strategy's density, sr⁻¹ at x
  Rgb radiance{0};
};

/// A point or direction from a strategy that samples points. pdf 0: no sample.
/// Only for the strategies that are neither bsdf nor lines.
LightSample sample(const AreaStrategy&, const LightView& view, const Vec2d& u);
LightSample sample(const SolidAngleStrategy&, const LightView& view, const Vec2d& u);
LightSample sample(const VisibleAreaStrategy&, const LightView& view, const Vec2d& u);
LightSample sample(const EnvironmentStrategy&, const LightView& view, const Vec2d& u);
LightSample sample(const PortalStrategy&, const LightView& view, const Vec2d& u);

/// Density of sample() at a direction that some strategy found, sr⁻¹.
double pdf(const BsdfStrategy&, const LightView& view, const LightSample& s);
double pdf(const AreaStrategy&, const LightView& view, const LightSample& s);
double pdf(const SolidAngleStrategy&, const LightView& view, const LightSample& s);
double pdf(const VisibleAreaStrategy&, const LightView& view, const LightSample& s);
double pdf(const EnvironmentStrategy&, const LightView& view, const LightSample& s);
double pdf(const PortalStrategy&, const LightView& view, const LightSample& s);

/// The line that a line strategy draws with u in [0,1), or the one that passes through a point.
/// scale 0: none.
LightLine choose(const LineAreaStrategy& strategy, const LightView& view, double u);
LightLine choose(const LineUniformStrategy& strategy, const LightView& view, double u);
LightLine choose(const LineAnalyticStrategy& strategy, const LightView& view, double u);
LightLine choose(const LineSolidAngleStrategy& strategy, const LightView& view, double u);
LightLine choose(const MapArcStrategy& strategy, const LightView& view, double u);
LightLine choose(const NormalArcStrategy& strategy, const LightView& view, double u);
LightLine choose(const PortalChordStrategy& strategy, const LightView& view, double u);
LightLine through(const LineAreaStrategy& strategy, const LightView& view, const Vec3d& p);
LightLine through(const LineUniformStrategy& strategy, const LightView& view, const Vec3d& p);
LightLine through(const LineAnalyticStrategy& strategy, const LightView& view, const Vec3d& p);
LightLine through(const LineSolidAngleStrategy& strategy, const LightView& view, const Vec3d& p);
LightLine through(const MapArcStrategy& strategy, const LightView& view, const Vec3d& p);
LightLine through(const NormalArcStrategy& strategy, const LightView& view, const Vec3d& p);
LightLine through(const PortalChordStrategy& strategy, const LightView& view, const Vec3d& p);

// The same, asked through the variant. A strategy of the other kind gives no sample, density 0, no line.
LightSample sample_point(const Strategy& strategy, const LightView& view, const Vec2d& u);
double density_of(const Strategy& strategy, const LightView& view, const LightSample& at);
LightLine choose_line(const Strategy& strategy, const LightView& view, double u);
LightLine line_through(const Strategy& strategy, const LightView& view, const Vec3d& p);

/// What Lambert's lobes at the view's point make of the visible part of a line, divided by the density of the
/// line's offset: an estimate of the light's part in it, by one random number.
Rgb closed_form(const LightView& view, const LightLine& line, std::span<const Interval> visible);

/// The same of [lo,hi], a part of one visible interval.
Rgb closed_form(const LightView& view, const LightLine& line, double lo, double hi);

/// A point of the view's area light as a sample (direction, radiance).
LightSample towards(const LightView& view, const LightPoint& at);
/// The point `at`, at s of a line, as a sample of the view's environment.
LightSample towards_sky(const LightView& view, const LightLine& line, double s, const LightPoint& at);

}  // namespace penumbra
