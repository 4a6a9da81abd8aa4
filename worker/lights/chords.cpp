#include "worker/lights/chords.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace penumbra {

/// The corners from the least offset s to the greatest, one way round.
class ParallelChords::Chain {
 public:
  Chain(std::span<const Corner> corners, int step) {
    const auto by_offset = [](const Corner& p, const Corner& q) { return p.s < q.s; };
    const auto least = std::min_element(corners.begin(), corners.end(), by_offset) - corners.begin();
    const auto greatest = std::max_element(corners.begin(), corners.end(), by_offset) - corners.begin();
    const auto count = static_cast<std::ptrdiff_t>(corners.size());
    for (auto i = least; size_ < corners.size(); i = (i + count + step) % count) {
      items_[size_++] = corners[i];
      if (i == greatest) break;
    }
  }

  /// Where the chord at offset s ends on the chain. Of an edge that is parallel to the chords, the corner
  /// that this chain passes last on the way up, or first at the top.
  Corner end_at(double s) const {
    size_t i = 1;
    while (i + 1 < size_ && items_[i].s <= s) ++i;
    const Corner &from = items_[i - 1], &to = items_[i];
    const double width = to.s - from.s;
    const double f = width > 0 ? std::min(std::max((s - from.s) / width, 0.0), 1.0) : 0;
    return {(1 - f) * from.position + f * to.position, (1 - f) * from.r + f * to.r, s};
  }

 private:
  std::array<Corner, kMostCorners> items_;
  size_t size_ = 0;
};

ParallelChords::ParallelChords(const LightShape& shape, double radians) {
  // Corners counter-clockwise about the normal.
  std::array<Corner, kMostCorners> corners;
  Vec3d u, v;
  if (const auto* quad = std::get_if<QuadShape>(&shape)) {
    corner_ = Vec3d(quad->o);
    u = Vec3d(quad->u);
    v = Vec3d(quad->v);
    corners[2].position = u + v;
    corners[3].position = v;
    count_ = 4;
  } else if (const auto* triangle = std::get_if<TriangleShape>(&shape)) {
    corner_ = Vec3d(triangle->p0);
    u = Vec3d(triangle->p1) - corner_;
    v = Vec3d(triangle->p2) - corner_;
    corners[2].position = v;
    count_ = 3;
  } else {
    return;
  }
  corners[1].position = u;
  normal_ = u.cross(v).normalized();
  const Vec3d x_axis = u.normalized(), y_axis = normal_.cross(x_axis);
  const Vec3d along = std::cos(radians) * x_axis + std::sin(radians) * y_axis;
  across_ = std::cos(radians) * y_axis - std::sin(radians) * x_axis;
  const std::span<Corner> used(corners.data(), static_cast<size_t>(count_));
  for (Corner& c : used) {
    c.r = c.position.dot(along);
    c.s = c.position.dot(across_);
  }
  cut_at_corners(used);
  if (!(area_below_[count_ - 1] > 0)) count_ = 0;
}

void ParallelChords::cut_at_corners(std::span<const Corner> corners) {
  std::array<double, kMostCorners> offsets;
  for (int i = 0; i < count_; ++i) {  // insertion sort
    const auto end = offsets.begin() + i, place = std::upper_bound(offsets.begin(), end, corners[i].s);
    std::move_backward(place, end, end + 1);
    *place = corners[i].s;
  }
  // From the corner of least offset up to the greatest: counter-clockwise the far ends, clockwise the near.
  const Chain far(corners, +1), near(corners, -1);
  for (int i = 0; i < count_; ++i) {
    const Corner a = near.end_at(offsets[i]), b = far.end_at(offsets[i]);
    cuts_[i] = {offsets[i], std::max(b.r - a.r, 0.0), a.position, b.position};
    area_below_[i] = i == 0 ? 0
                            : area_below_[i - 1] + 0.5 * (cuts_[i].offset - cuts_[i - 1].offset) *
                                                       (cuts_[i].length + cuts_[i - 1].length);
  }
}

LightLine ParallelChords::line_between(const Cut& below, const Cut& above, double fraction) const {
  const Vec3d a = (1 - fraction) * below.a + fraction * above.a;
  const Vec3d b = (1 - fraction) * below.b + fraction * above.b;
  LightLine line;
  line.corner = corner_;
  line.from = a;
  line.along = b - a;
  line.a = corner_ + a;
  line.b = corner_ + b;
  line.n = normal_;
  line.scale = 1 / area_below_[count_ - 1];
  line.measure = LengthMeasure{};
  return line;
}

LightLine ParallelChords::choose(double u) const {
  if (count_ == 0) return {};
  const double target = u * area_below_[count_ - 1];
  int i = 1;
  while (i + 1 < count_ && !(target < area_below_[i])) ++i;
  const Cut &below = cuts_[i - 1], &above = cuts_[i];
  // Within a trapezium of parallel sides ℓ0, ℓ1 the fraction f of its height below which the fraction ξ of
  // its area lies solves ℓ0 f + (ℓ1 − ℓ0) f²/2 = ξ (ℓ0 + ℓ1)/2; there ℓ² = (1−ξ) ℓ0² + ξ ℓ1², and f = ξ (ℓ0 +
  // ℓ1)/(ℓ0 + ℓ), without the cancellation of (ℓ − ℓ0)/(ℓ1 − ℓ0).
  const double area = area_below_[i] - area_below_[i - 1];
  const double xi = area > 0 ? std::min(std::max((target - area_below_[i - 1]) / area, 0.0), 1.0) : 0;
  const double length = std::sqrt((1 - xi) * below.length * below.length + xi * above.length * above.length);
  const double sum = below.length + length;
  return line_between(below, above, sum > 0 ? std::min(xi * (below.length + above.length) / sum, 1.0) : 0);
}

LightLine ParallelChords::at_offset(double s) const {
  int i = 1;
  while (i + 1 < count_ && !(s < cuts_[i].offset)) ++i;
  const double height = cuts_[i].offset - cuts_[i - 1].offset;
  // The offset lies in the polygon to rounding: what sticks out is moved to its border.
  const double f = height > 0 ? std::min(std::max((s - cuts_[i - 1].offset) / height, 0.0), 1.0) : 0;
  return line_between(cuts_[i - 1], cuts_[i], f);
}

LightLine ParallelChords::through(const Vec3d& p) const {
  return count_ == 0 ? LightLine() : at_offset((p - corner_).dot(across_));
}

LightLine ParallelChords::uniform(LightLine line) const {
  const double area = (cuts_[count_ - 1].offset - cuts_[0].offset) * line.along.length();
  line.scale = area > 0 ? 1 / area : 0;
  return line;
}

LightLine ParallelChords::choose_uniform(double u) const {
  if (count_ == 0) return {};
  return uniform(at_offset((1 - u) * cuts_[0].offset + u * cuts_[count_ - 1].offset));
}

LightLine ParallelChords::through_uniform(const Vec3d& p) const {
  return count_ == 0 ? LightLine() : uniform(through(p));
}

}  // namespace penumbra
