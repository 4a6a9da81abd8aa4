#pragma once
// Discontinuity-smoothing MIS (Salesin & Jarosz 2019, §5; design §6): a factor s(l) in [0,1] of the densities
// of strategies that sample points. It falls to 0 where their integrand jumps (the light's border, the edge
// of a shadow on it), so that lines, which see those edges, take over there. A function of the point l alone:
// the same in the weights of every strategy, whichever found l.
#include <optional>
#include <span>

#include "proto/mix.h"
#include "worker/lights/line.h"

namespace penumbra {

/// How far from an edge s is below 1, and how it falls.
struct Smoothing {
  SmoothShape shape = SmoothShape::kCubic;
  /// Scene units; empty: kAutoWidth of the light's extent across its edge, or of the chord's length.
  std::optional<double> width;
};

/// `auto`, as a share of the light's extent in the direction in question; why this one: README.md.
constexpr double kAutoWidth = 1;

/// From 0 at t <= 0 to 1 at t >= 1: 3t² − 2t³, or the ease-in 2t − t².
double rise(SmoothShape shape, double t);

/// Factor of the border of a flat light: product over its edges. 1 for what has no straight edges.
double border_factor(const Smoothing& smoothing, const LightShape& light, const Vec3d& l);

/// Factor of what is hidden on a line, seen from its point s. On either side of s, with `seen` and `hidden`
/// the lengths of the chord's visible and hidden parts from s up to the end of some hidden gap,
///   rise(min over the gaps of seen / min(hidden, width)).
/// One gap at distance d: d / width, or d / its own length if that is less, so that a gap which closes takes
/// its effect with it; and a sliver that closes between two gaps leaves the effect of one. So s is continuous
/// in the gaps' ends. 0 in a gap. The chord's own ends are the border's matter.
double line_factor(const Smoothing& smoothing, const LightLine& line, std::span<const Interval> visible,
                   double s);

}  // namespace penumbra
