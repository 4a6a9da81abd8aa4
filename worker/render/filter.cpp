#include "worker/render/filter.h"

#include <algorithm>
#include <cmath>

#include "proto/status.h"

namespace penumbra {
namespace {

// Knots of a tabulated filter. The table *is* the filter (its linear interpolant is sampled exactly), so
// this sets how close the interpolant is to pbrt's formula: an error of (radius/256)²/8 · max|f''|,
// below 1e-4 of the peak for all four filters.
constexpr int kKnots = 513;

double gaussian(double x, double alpha, double radius) {
  return std::max(0.0, std::exp(-alpha * x * x) - std::exp(-alpha * radius * radius));
}

/// Mitchell & Netravali 1988 on [-2,2].
double mitchell(double x, double b, double c) {
  x = std::abs(x);
  if (x > 1)
    return ((-b - 6 * c) * x * x * x + (6 * b + 30 * c) * x * x + (-12 * b - 48 * c) * x + (8 * b + 24 * c)) / 6;
  return ((12 - 9 * b - 6 * c) * x * x * x + (-18 + 12 * b + 6 * c) * x * x + (6 - 2 * b)) / 6;
}

}  // namespace

template <class F>
Filter::Axis Filter::tabulate(double radius, F f) {
  Axis axis;
  axis.radius = radius;
  axis.values.resize(kKnots);
  axis.sums.assign(kKnots, 0);
  const double step = 2 * radius / (kKnots - 1);
  for (int i = 0; i < kKnots; ++i) axis.values[size_t(i)] = f(-radius + i * step);
  double signed_sum = 0;
  for (size_t i = 1; i < size_t(kKnots); ++i) {
    const double a = axis.values[i - 1], b = axis.values[i];
    axis.sums[i] = axis.sums[i - 1] + (std::abs(a) + std::abs(b)) / 2 * step;
    signed_sum += (a + b) / 2 * step;
  }
  axis.sign_ratio = axis.sums.back() / signed_sum;
  return axis;
}

double Filter::Axis::sample(double u, double& weight) const {
  if (values.empty()) return radius * (2 * u - 1);
  const double target = u * sums.back();
  size_t i = size_t(std::upper_bound(sums.begin(), sums.end(), target) - sums.begin());
  i = std::clamp<size_t>(i, 1, values.size() - 1) - 1;
  const double step = 2 * radius / double(values.size() - 1);
  const double a = std::abs(values[i]), b = std::abs(values[i + 1]);
  // Solve a t + (b-a) t²/2 = rest for t in [0,1], in the form that does not cancel.
  const double rest = (target - sums[i]) / step;
  const double root = std::sqrt(std::max(0.0, a * a + 2 * (b - a) * rest));
  const double t = a + root > 0 ? std::min(1.0, 2 * rest / (a + root)) : 0;
  const double value = values[i] + (values[i + 1] - values[i]) * t;
  // Within a knot interval that changes sign the table of |f| and the interpolant of f differ; the ratio
  // keeps the estimate exact.
  const double density = a + (b - a) * t;
  weight *= density > 0 ? value / density * sign_ratio : 0;
  return -radius + (double(i) + t) * step;
}

double Filter::Axis::place_of(double offset) const {
  if (!(radius > 0)) return 0.5;
  const double along = std::clamp((offset + radius) / (2 * radius), 0.0, 1.0);
  if (values.empty()) return along;
  const double knots = double(values.size() - 1), at = along * knots;
  const size_t i = std::min(size_t(at), values.size() - 2);
  const double t = at - double(i), step = 2 * radius / knots;
  const double a = std::abs(values[i]), b = std::abs(values[i + 1]);
  return std::min((sums[i] + step * t * (a + (b - a) * t / 2)) / sums.back(), 1.0);
}

Filter Filter::centre() {
  Filter filter;
  for (Axis& axis : filter.axes_) axis.radius = 0;
  return filter;
}

FilterSample Filter::sample(const Vec2d& u) const {
  FilterSample s;
  s.offset.x = axes_[0].sample(u.x, s.weight);
  s.offset.y = axes_[1].sample(u.y, s.weight);
  return s;
}

absl::StatusOr<Filter> Filter::build(const SceneDescription& description, std::vector<std::string>& warnings) {
  const Entity& e = description.filter;
  const std::string type = e.type.empty() ? "box" : e.type;
  const bool v4 = e.params.find("xradius") || e.params.find("yradius") || e.params.find("sigma");
  const double fallback = type == "box" ? 0.5 : type == "gaussian" && v4 ? 1.5 : 2;
  const double radii[2] = {e.params.number(v4 ? "xradius" : "xwidth", fallback),
                           e.params.number(v4 ? "yradius" : "ywidth", fallback)};
  Filter filter;
  for (int k = 0; k < 2; ++k) {
    const double r = radii[k];
    if (!(r > 0) || !std::isfinite(r))
      return invalid_input("{}: pixel filter radius {} must be positive", description.place(e.loc), r);
    if (type == "box") {
      filter.axes_[k].radius = r;
    } else if (type == "triangle") {
      filter.axes_[k] = tabulate(r, [&](double x) { return r - std::abs(x); });
    } else if (type == "mitchell") {
      const double b = e.params.number("B", 1.0 / 3), c = e.params.number("C", 1.0 / 3);
      filter.axes_[k] = tabulate(r, [&](double x) { return mitchell(2 * x / r, b, c); });
    } else {
      if (type != "gaussian" && k == 0)
        warnings.push_back(fmt::format("{}: pixel filter \"{}\" is rendered as \"gaussian\"",
                                       description.place(e.loc), type));
      const double sigma = e.params.number("sigma", 0.5);
      const double alpha = v4 ? 1 / (2 * sigma * sigma) : e.params.number("alpha", 2);
      filter.axes_[k] = tabulate(r, [&](double x) { return gaussian(x, alpha, r); });
    }
  }
  return filter;
}

}  // namespace penumbra
