#include "worker/lights/line.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "worker/lights/chord_measure.h"
#include "worker/lights/chords.h"
#include "worker/lights/triangle_fan.h"

namespace penumbra {

bool has_line_area(const LightShape& shape) {
  return std::holds_alternative<QuadShape>(shape) || std::holds_alternative<TriangleShape>(shape);
}

bool has_line_solid_angle(const LightShape& shape) {
  const auto* quad = std::get_if<QuadShape>(&shape);
  return std::holds_alternative<TriangleShape>(shape) || (quad != nullptr && quad->rectangle());
}

LightLine choose_line_area(const LightShape& shape, double radians, double u) {
  return ParallelChords(shape, radians).choose(u);
}

LightLine line_area_through(const LightShape& shape, double radians, const Vec3d& p) {
  return ParallelChords(shape, radians).through(p);
}

namespace {

/// The rectangle's chord at a fraction of the edge across it.
LightLine rectangle_line(const SeenShape& seen, bool along_u, const RectangleChord& chord, double fraction) {
  const auto& quad = std::get<QuadShape>(seen.shape());
  LightLine line;
  line.corner = Vec3d(quad.o);
  line.from = fraction * Vec3d(along_u ? quad.v : quad.u);
  line.along = Vec3d(along_u ? quad.u : quad.v);
  line.a = line.corner + line.from;
  line.b = line.a + line.along;
  line.n = seen.rectangle()->normal();
  line.scale = 1 / seen.solid_angle();
  line.measure =
      AngularMeasure{chord.y0, chord.length, chord.d2, height_difference(chord.y0, chord.length, chord.d2)};
  return line;
}

}  // namespace

LightLine choose_line_solid_angle(const SeenShape& seen, bool along_u, double u) {
  if (seen.solid_angle() == 0) return {};
  if (const auto* triangle = std::get_if<TriangleShape>(&seen.shape()))
    return TriangleFan(*triangle, seen.x(), along_u, seen.solid_angle()).choose(u);
  const SphericalRectangle* rectangle = seen.rectangle();
  if (rectangle == nullptr) return {};
  const RectangleChord chord = rectangle->chord(along_u, u);
  return rectangle_line(seen, along_u, chord, chord.offset.t / rectangle->edge_length(along_u ? 1 : 0));
}

LightLine line_solid_angle_through(const SeenShape& seen, bool along_u, const Vec3d& p) {
  if (seen.solid_angle() == 0) return {};
  if (const auto* triangle = std::get_if<TriangleShape>(&seen.shape()))
    return TriangleFan(*triangle, seen.x(), along_u, seen.solid_angle()).through(p);
  const SphericalRectangle* rectangle = seen.rectangle();
  if (rectangle == nullptr) return {};
  const auto& quad = std::get<QuadShape>(seen.shape());
  const Vec3d across(along_u ? quad.v : quad.u);
  // p lies on the rectangle to rounding: what sticks out is moved to its border.
  const double fraction = std::min(std::max((p - Vec3d(quad.o)).dot(across) / across.length2(), 0.0), 1.0);
  return rectangle_line(seen, along_u, rectangle->chord_at(along_u, fraction), fraction);
}

LightLine arc_line(const Vec3d& x, const Vec3d& pole, const Vec3d& equator, double radius,
                   const ArcMeasure& measure, double scale) {
  LightLine line;
  line.corner = x;
  line.from = radius * pole;
  line.along = radius * (equator - pole);
  line.a = line.corner + line.from;
  line.b = line.a + line.along;
  line.scale = scale;
  line.measure = measure;
  return line;
}

double parameter_of(const LightLine& line, const Vec3d& p) {
  if (std::holds_alternative<ArcMeasure>(line.measure)) {
    const Vec3d w = p - line.corner;
    const double to_pole = std::max(w.dot(line.from), 0.0),
                 to_equator = std::max(w.dot(line.from + line.along), 0.0);
    return to_pole + to_equator > 0 ? to_equator / (to_pole + to_equator) : 0;
  }
  const double length2 = line.along.length2();
  if (!(length2 > 0)) return 0;
  return std::min(std::max(((p - line.corner) - line.from).dot(line.along) / length2, 0.0), 1.0);
}

namespace {

double relative_measure_of(const LengthMeasure&, double lo, double hi) {
  return hi - lo;
}
double relative_measure_of(const AngularMeasure& m, double lo, double hi) {
  if (!(m.total > 0)) return hi - lo;
  return height_difference(m.y0 + lo * m.length, (hi - lo) * m.length, m.d2) / m.total;
}
double relative_measure_of(const ApexMeasure& m, double lo, double hi) {
  if (!(m.total > 0)) return hi - lo;
  return versine_difference(m.t0, m.d, lo * m.length, hi * m.length) / m.total;
}

/// The point of [lo,hi] at fraction v of its measure.
double sample_within_measure(const LengthMeasure&, double lo, double hi, double v) {
  return lo + v * (hi - lo);
}
double sample_within_measure(const AngularMeasure& m, double lo, double hi, double v) {
  if (!(m.total > 0)) return lo + v * (hi - lo);
  return lo + sample_height(m.y0 + lo * m.length, (hi - lo) * m.length, m.d2, v) / m.length;
}
double sample_within_measure(const ApexMeasure& m, double lo, double hi, double v) {
  if (!(m.total > 0)) return lo + v * (hi - lo);
  return sample_versine(m.t0, m.d, lo * m.length, hi * m.length, v) / m.length;
}

/// Light point minus x.
Vec3d offset_from(const LightLine& line, const Vec3d& x, double s) {
  return (line.corner - x) + (line.from + s * line.along);
}

/// Density per solid angle with the whole chord visible.
double base_density(const LightLine& line, const Vec3d& x, double s) {
  if (const auto* arc = std::get_if<ArcMeasure>(&line.measure)) return line.scale * arc_value(*arc, s);
  const double height = (x - line.corner).dot(line.n);
  if (!(height > 0)) return 0;
  if (!std::holds_alternative<LengthMeasure>(line.measure)) return line.scale;
  const double r2 = offset_from(line, x, s).length2();
  return line.scale * r2 * std::sqrt(r2) / height;
}

}  // namespace

double relative_measure(const LightLine& line, double lo, double hi) {
  if (!(lo < hi)) return 0;
  return std::visit([&](const auto& m) { return relative_measure_of(m, lo, hi); }, line.measure);
}

double visible_measure(const LightLine& line, std::span<const Interval> visible) {
  double sum = 0;
  for (const Interval& part : visible) sum += relative_measure(line, part.lo, part.hi);
  return sum;
}

double sample_within(const LightLine& line, double lo, double hi, double v) {
  return std::visit([&](const auto& m) { return sample_within_measure(m, lo, hi, v); }, line.measure);
}

double sample_parameter(const LightLine& line, std::span<const Interval> visible, double measure, double v) {
  return sample_parts(line, visible, measure, v);
}

LightPoint sample_line(const LightLine& line, const Vec3d& x, std::span<const Interval> visible, double v) {
  const double measure = visible_measure(line, visible);
  if (!(measure > 0)) return {};
  const double s = sample_parameter(line, visible, measure, v);
  return {line.corner + (line.from + s * line.along), line.n, pdf_line(line, x, s, measure)};
}

double pdf_line(const LightLine& line, const Vec3d& x, double s, double visible_measure) {
  return visible_measure > 0 ? base_density(line, x, s) / visible_measure : 0;
}

Interval clip_to_horizon(const LightLine& line, const Vec3d& x, const Vec3d& n) {
  const Vec3d a = (line.corner - x) + line.from;
  const double height_a = a.dot(n), height_b = (a + line.along).dot(n);
  if (height_a >= 0 && height_b >= 0) return {0, 1};
  if (!(height_a > 0) && !(height_b > 0)) return {0, 0};
  const double crossing = height_a / (height_a - height_b);  // of opposite signs: nothing cancels
  const float nearest = static_cast<float>(crossing);
  return height_a > 0 ? Interval{0, std::min(std::nextafter(nearest, 2.f), 1.f)}
                      : Interval{std::max(std::nextafter(nearest, -1.f), 0.f), 1};
}

}  // namespace penumbra
