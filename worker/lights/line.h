#pragma once
// Lines on flat light shapes (design §5): a chord chosen with density p(u); a point on its visible part
// chosen with the strategy's conditional density. Visibility is not known here: it comes in as intervals.
#include <algorithm>
#include <optional>
#include <span>

#include "worker/geometry/intervals.h"
#include "worker/lights/arc.h"
#include "worker/lights/shape.h"

namespace penumbra {

/// How points are spread along a chord: uniform in length (line-area), or uniform in
/// h = y/√(d²+y²) (line-sa; y: signed offset from the foot of x along the chord).
struct LengthMeasure {};
struct AngularMeasure {
  double y0 = 0, length = 0, d2 = 0;
  double total = 0;  ///< h(y0 + length) − h(y0)
};
/// Uniform in the versine 1 − cosθ of the angle at x from the chord's first end, an apex (line-sa,
/// triangles).
struct ApexMeasure {
  double t0 = 0, length = 0, d = 0;  ///< of the apex, along the chord from the foot of x; distance of x
  double total = 0;                  ///< versine of the other end
};

/// A chord of a light, chosen by a line strategy. P(s) = a + s (b - a), s in [0,1]. A default-made line is
/// «no such line»: every density on it is 0.
struct LightLine {
  Vec3d a{0, 0, 0}, b{0, 0, 0};
  Vec3d n{0, 0, 0};  ///< unit normal of the light's plane, emission side
  /// Density per solid angle of a point at s = base(s) * total/visible, in the measure below;
  /// for LengthMeasure: scale r²/cosθ, with scale × chord length the density of the chord's offset
  /// (1/A where that goes with the length); for ArcMeasure: scale × arc_value(s); for
  /// the others: scale = 1/S.
  double scale = 0;  ///< 0: no such line
  std::variant<LengthMeasure, AngularMeasure, ApexMeasure, ArcMeasure> measure;
  /// a and b without the rounding of large scene offsets: a = corner + from, b = a + along, corner exact.
  Vec3d corner{0, 0, 0}, from{0, 0, 0}, along{0, 0, 0};
};

/// `line-area@DEG` on a quad or triangle: direction at `radians` from the first edge (u, or p0→p1),
/// turning towards the second, in the light's plane; the offset has density chord length / area. (Several
/// lines of one light: keep a ParallelChords, chords.h.)
LightLine choose_line_area(const LightShape& shape, double radians, double u);
/// The line of that strategy through a point p of the shape.
LightLine line_area_through(const LightShape& shape, double radians, const Vec3d& p);

/// `line-sa@u` / `line-sa@v`: on a rectangle, lines parallel to edge u (`along_u`) or v; on a triangle, lines
/// through a corner (triangle_fan.h).
LightLine choose_line_solid_angle(const SeenShape& seen, bool along_u, double u);
LightLine line_solid_angle_through(const SeenShape& seen, bool along_u, const Vec3d& p);

/// A quarter of a great circle about x (arc.h), from `pole` to `equator`, unit and at right angles, as a
/// chord of a circle of that radius. `n` stays 0: it has no side.
LightLine arc_line(const Vec3d& x, const Vec3d& pole, const Vec3d& equator, double radius,
                   const ArcMeasure& measure, double scale);

/// Which strategies a shape has lines for: quads and triangles; rectangles and triangles.
bool has_line_area(const LightShape& shape);
bool has_line_solid_angle(const LightShape& shape);

/// Where p lies on the line, s in [0,1]; of an arc, where it lies from x.
double parameter_of(const LightLine& line, const Vec3d& p);

/// Measure of [lo,hi] relative to the whole chord's (so the whole chord has 1); stable for short parts.
double relative_measure(const LightLine& line, double lo, double hi);

/// Sum of relative_measure over the visible intervals.
double visible_measure(const LightLine& line, std::span<const Interval> visible);

/// Parameter s at fraction v in [0,1) of the visible measure, whose sum is `measure` > 0.
double sample_parameter(const LightLine& line, std::span<const Interval> visible, double measure, double v);

/// The point of [lo,hi] at fraction v in [0,1] of its measure.
double sample_within(const LightLine& line, double lo, double hi, double v);

/// The same for the parts (with members lo and hi) of a line, whose measures sum to `measure` > 0.
template <class Part>
double sample_parts(const LightLine& line, std::span<const Part> parts, double measure, double v) {
  double rest = v * measure;
  for (size_t i = 0;; ++i) {
    const double lo = parts[i].lo, hi = parts[i].hi, part = relative_measure(line, lo, hi);
    if (rest < part || i + 1 == parts.size())
      return sample_within(line, lo, hi, part > 0 ? std::min(rest / part, 1.0) : 0);
    rest -= part;
  }
}

/// Point at fraction v in [0,1) of the visible measure, and its density per solid angle at x.
/// Nothing visible, or x behind the light: pdf 0.
LightPoint sample_line(const LightLine& line, const Vec3d& x, std::span<const Interval> visible, double v);

/// Density of sample_line at a visible s (the caller knows whether s is: 0 for a hidden one).
/// `visible_measure`: sum of relative_measure over the visible intervals; 0: the density is 0. (1 for the
/// density as if nothing hid the chord: the weights of `/free`.)
double pdf_line(const LightLine& line, const Vec3d& x, double s, double visible_measure);

/// The part of the chord above the plane through x with unit normal n: [lo,hi], empty if lo >= hi. Rounded
/// outwards: light from a hair below the horizon counts 0 by its cosine, light from above must not be lost.
Interval clip_to_horizon(const LightLine& line, const Vec3d& x, const Vec3d& n);

}  // namespace penumbra
