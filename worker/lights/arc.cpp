#include "worker/lights/arc.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "proto/status.h"

namespace penumbra {
namespace {

constexpr double kPi = std::numbers::pi;

/// s where the angle from the pole has this tangent; infinite: the chord's end.
double parameter_of_tangent(double t) {
  return std::isinf(t) ? 1 : t / (1 + t);
}

}  // namespace

Vec2d arc_direction(double s) {
  const double n = std::hypot(1 - s, s);
  return {(1 - s) / n, s / n};
}

double squared_sine_difference(double lo, double hi) {
  // sin(β − α) sin(β + α): the sines from the directions' cross product and its counterpart.
  const double n2 = ((1 - lo) * (1 - lo) + lo * lo) * ((1 - hi) * (1 - hi) + hi * hi);
  return (hi - lo) * (hi * (1 - lo) + lo * (1 - hi)) / n2;
}

double cosine_difference(double lo, double hi) {
  const double cosines = arc_direction(lo).x + arc_direction(hi).x;
  return cosines > 0 ? squared_sine_difference(lo, hi) / cosines : 0;
}

ArcTable::ArcTable(int width, int height, const std::vector<double>& values)
    : width_(width), height_(height), values_(values) {
  PENUMBRA_CHECK(width > 0 && height > 0 && values.size() == size_t(width) * size_t(height));
  down_.assign(size_t(width) * (size_t(height) + 1), 0);
  for (int x = 0; x < width; ++x) {
    double* sums = &down_[size_t(x) * (size_t(height) + 1)];
    for (int y = 0; y < height; ++y) {
      // cos a − cos b as a product: the caps at the poles are thin.
      const double zone = 2 * std::sin(kPi * (y + 0.5) / height) * std::sin(kPi / 2 / height);
      sums[y + 1] = sums[y] + value(x, y) * zone;
    }
  }
  halves_.assign(2 * size_t(width) + 1, 0);
  for (size_t h = 0; h < 2 * size_t(width); ++h)
    halves_[h + 1] = halves_[h] + half_measure(int(h / 2), h % 2 == 1) * 2 * kPi / width;
  total_ = halves_.back();
  PENUMBRA_CHECK(total_ > 0);
}

double ArcTable::edge(int k) const {
  return 2 * k >= height_ ? 1 : parameter_of_tangent(std::tan(kPi * k / height_));
}

double ArcTable::rows_before(const Meridian& m, int k) const {
  const double* sums = &down_[size_t(m.column) * (size_t(height_) + 1)];
  return m.lower ? sums[height_] - sums[height_ - k] : sums[k];
}

double ArcTable::half_measure(int column, bool lower) const {
  const Meridian m{column, lower, 0};
  const double whole = rows_before(m, height_ / 2);
  // The equator halves the middle row of an odd number.
  return height_ % 2 == 0 ? whole : whole + value_from_pole(m, height_ / 2) * std::sin(kPi / 2 / height_);
}

ArcTable::Meridian ArcTable::choose(double u) const {
  const double target = u * total_;
  auto h = size_t(std::upper_bound(halves_.begin(), halves_.end(), target) - halves_.begin());
  h = std::min(h == 0 ? 0 : h - 1, halves_.size() - 2);
  while (h > 0 && halves_[h + 1] == halves_[h]) --h;
  const double part = halves_[h + 1] - halves_[h];
  const double within = part > 0 ? std::min((target - halves_[h]) / part, 1 - 0x1p-53) : 0;
  const int column = int(h / 2);
  return {column, h % 2 == 1, 2 * kPi * (column + within) / width_};
}

ArcTable::Meridian ArcTable::through(const Vec3d& w) const {
  double phi = std::atan2(w.y, w.x);
  if (phi < 0) phi += 2 * kPi;
  return {std::clamp(int(phi / (2 * kPi) * width_), 0, width_ - 1), w.z < 0, phi};
}

int ArcTable::row_from_pole(double s) const {
  return std::clamp(int(std::atan2(s, 1 - s) / kPi * height_), 0, height_ / 2 - (height_ % 2 == 0 ? 1 : 0));
}

int ArcTable::row_at(const Meridian& m, double s) const {
  const int k = row_from_pole(s);
  return m.lower ? height_ - 1 - k : k;
}

double ArcTable::measure(const Meridian& m, double lo, double hi) const {
  const int first = row_from_pole(lo), last = row_from_pole(hi);
  if (first == last) return value_from_pole(m, first) * cosine_difference(lo, hi);
  return value_from_pole(m, first) * cosine_difference(lo, std::max(edge(first + 1), lo)) +
         (rows_before(m, last) - rows_before(m, first + 1)) +
         value_from_pole(m, last) * cosine_difference(std::min(edge(last), hi), hi);
}

double ArcTable::sample(const Meridian& m, double lo, double hi, double v) const {
  const int first = row_from_pole(lo), last = row_from_pole(hi);
  double target = v * measure(m, lo, hi);
  // The row in which the target lies, and its part of [lo,hi].
  int row = first;
  double from = lo, to = first == last ? hi : std::max(edge(first + 1), lo);
  const double head = value_from_pole(m, first) * cosine_difference(from, to);
  if (first != last && target >= head) {
    const double before = target - head + rows_before(m, first + 1);
    row = first + 1;
    for (int beyond = last + 1; row + 1 < beyond;) {  // rows_before(row) <= before < rows_before(beyond)
      const int middle = row + (beyond - row) / 2;
      if (rows_before(m, middle) <= before)
        row = middle;
      else
        beyond = middle;
    }
    target = before - rows_before(m, row);
    from = std::min(edge(row), hi);
    to = row == last ? hi : std::min(edge(row + 1), hi);
  }
  const double value = value_from_pole(m, row);
  if (!(value > 0)) return from;
  // The versine 1 − cos α grows by target / value; that of `from` without cancellation.
  const Vec2d start = arc_direction(from);
  const double grown = target / value, versine = start.y * start.y / (1 + start.x) + grown;
  const double cosine = start.x - grown, sine = std::sqrt(std::max(versine * (1 + cosine), 0.0));
  return std::clamp(cosine > 0 ? sine / (cosine + sine) : 1.0, from, to);
}

double relative_measure_of(const ArcMeasure& m, double lo, double hi) {
  if (m.table == nullptr) return squared_sine_difference(lo, hi);
  return m.table->measure(m.meridian, lo, hi) / m.total;
}

double sample_within_measure(const ArcMeasure& m, double lo, double hi, double v) {
  if (m.table != nullptr) return m.table->sample(m.meridian, lo, hi, v);
  const double whole = squared_sine_difference(lo, hi);
  const double sine2 = arc_direction(lo).y * arc_direction(lo).y + v * whole;
  const double cosine2 = arc_direction(hi).x * arc_direction(hi).x + (1 - v) * whole;
  const double t = cosine2 > 0 ? std::sqrt(sine2 / cosine2) : HUGE_VAL;
  return std::clamp(parameter_of_tangent(t), lo, hi);
}

double arc_value(const ArcMeasure& m, double s) {
  return m.table != nullptr ? m.table->value_at(m.meridian, s) : arc_direction(s).x;
}

}  // namespace penumbra
