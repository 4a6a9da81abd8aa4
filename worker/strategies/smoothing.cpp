#include "worker/strategies/smoothing.h"

#include <algorithm>
#include <array>

namespace penumbra {
namespace {

/// rise() of a distance, which may be as long as the width that it is measured by is short.
double rise_over(const Smoothing& smoothing, double distance, double width) {
  return distance >= width ? 1 : rise(smoothing.shape, distance / width);
}

/// The factor of the edge a→b: `far` is a corner at the greatest distance from it.
double edge_factor(const Smoothing& smoothing, const Vec3d& a, const Vec3d& b, const Vec3d& far,
                   const Vec3d& l) {
  const Vec3d edge = b - a;
  const double length = edge.length(), extent = edge.cross(far - a).length() / length;
  const double distance = edge.cross(l - a).length() / length;
  return rise_over(smoothing, distance, smoothing.width.value_or(kAutoWidth * extent));
}

/// Walks from a point of a line to one of its ends, over the gaps.
class Walk {
 public:
  explicit Walk(double width) : width_(width) {}
  void see(double length) { seen_ += length; }
  void miss(double length) {
    hidden_ += length;
    const double width = std::min(hidden_, width_);
    if (seen_ < least_ * width) least_ = seen_ / width;
  }
  /// The least of seen / min(hidden, width) so far, or 1 if that is less.
  double least() const { return least_; }

 private:
  double width_, seen_ = 0, hidden_ = 0, least_ = 1;
};

}  // namespace

double rise(SmoothShape shape, double t) {
  const double u = std::min(std::max(t, 0.0), 1.0);
  return shape == SmoothShape::kCubic ? u * u * (3 - 2 * u) : u * (2 - u);
}

double border_factor(const Smoothing& smoothing, const LightShape& light, const Vec3d& l) {
  if (const auto* quad = std::get_if<QuadShape>(&light)) {
    const Vec3d o(quad->o), u(quad->u), v(quad->v), p = l - o, far = u + v, zero(0, 0, 0);
    return edge_factor(smoothing, zero, u, far, p) * edge_factor(smoothing, zero, v, far, p) *
           edge_factor(smoothing, v, far, zero, p) * edge_factor(smoothing, u, far, zero, p);
  }
  if (const auto* triangle = std::get_if<TriangleShape>(&light)) {
    const Vec3d o(triangle->p0), u = Vec3d(triangle->p1) - o, v = Vec3d(triangle->p2) - o, p = l - o,
                                 zero(0, 0, 0);
    return edge_factor(smoothing, zero, u, v, p) * edge_factor(smoothing, zero, v, u, p) *
           edge_factor(smoothing, u, v, zero, p);
  }
  return 1;
}

double line_factor(const Smoothing& smoothing, const LightLine& line, std::span<const Interval> visible,
                   double s) {
  // Lengths as shares of the chord's.
  const double length = line.along.length();
  if (!(length > 0)) return 1;
  const double width = smoothing.width ? *smoothing.width / length : kAutoWidth;
  size_t own = 0;
  while (own < visible.size() && !(s <= visible[own].hi)) ++own;
  if (own == visible.size() || s < visible[own].lo) return 0;

  Walk up(width), down(width);
  up.see(visible[own].hi - s);
  for (size_t i = own; i < visible.size(); ++i) {
    const bool last = i + 1 == visible.size();
    const double end = last ? 1 : visible[i + 1].lo;
    if (end > visible[i].hi) up.miss(end - visible[i].hi);
    if (!last) up.see(visible[i + 1].length());
  }
  down.see(s - visible[own].lo);
  for (size_t i = own + 1; i-- > 0;) {
    const double end = i == 0 ? 0 : visible[i - 1].hi;
    if (visible[i].lo > end) down.miss(visible[i].lo - end);
    if (i > 0) down.see(visible[i - 1].length());
  }
  return rise(smoothing.shape, up.least()) * rise(smoothing.shape, down.least());
}

}  // namespace penumbra
