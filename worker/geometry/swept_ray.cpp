#include "worker/geometry/swept_ray.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace penumbra {
namespace {

/// c0 + c1 s + c2 s².
struct Quadratic {
  double c0, c1, c2;

  /// From its values at 0, ½ and 1.
  static Quadratic through(double at_0, double at_half, double at_1) {
    const double c2 = 2 * (at_0 - 2 * at_half + at_1);
    return {at_0, at_1 - at_0 - c2, c2};
  }
  /// Appends its roots in (0,1). No term cancels: the root of larger size is taken first.
  void roots(double* out, int& n) const {
    const double discriminant = c1 * c1 - 4 * c2 * c0;
    if (!(discriminant >= 0)) return;
    const double q = -0.5 * (c1 + std::copysign(std::sqrt(discriminant), c1));
    for (const double root : {q / c2, c0 / q})
      if (root > 0 && root < 1) out[n++] = root;
  }
};

/// Half the range of a functional over a box, and its middle.
struct Range {
  double middle, half;
};
Range range_of(const Vec3d& functional, const LineNode& node, int lane) {
  Range range{0, 0};
  for (int k = 0; k < 3; ++k) {
    range.middle += functional[k] * 0.5 * (double{node.lo[k][lane]} + node.hi[k][lane]);
    range.half += std::abs(functional[k]) * 0.5 * (double{node.hi[k][lane]} - node.lo[k][lane]);
  }
  return range;
}

Vec3d any_across(const Vec3d& d) {
  const Vec3d axis = std::abs(d.x) < std::abs(d.y) ? Vec3d(1, 0, 0) : Vec3d(0, 1, 0);
  return d.cross(axis);
}

}  // namespace

int covers_of_triangle(const SweptRay& ray, const Vec3f p[3], TimeCover covers[kMostCovers]) {
  double edges[3][3];  // [edge][at s = 0, ½, 1]; > 0: the ray passes on the left
  for (int at = 0; at < 3; ++at) {
    const Vec3d o = ray.origin_at(0.5 * at), d = ray.direction_at(0.5 * at);
    const Vec3d q[3] = {Vec3d(p[0]) - o, Vec3d(p[1]) - o, Vec3d(p[2]) - o};
    for (int e = 0; e < 3; ++e) edges[e][at] = d.dot(q[e].cross(q[(e + 1) % 3]));
  }
  // Most triangles are passed by on one side: a quadratic has one sign where its Bernstein coefficients have.
  bool left = false, right = false;
  for (const double* e : edges) {
    const double control = 2 * e[1] - 0.5 * (e[0] + e[2]);
    left |= e[0] > 0 && control > 0 && e[2] > 0;
    right |= e[0] < 0 && control < 0 && e[2] < 0;
  }
  if (left && right) return 0;
  double ends[8] = {0};
  int n = 1;
  for (const double* e : edges) Quadratic::through(e[0], e[1], e[2]).roots(ends, n);
  // Six at most: by insertion.
  for (int i = 2; i < n; ++i)
    for (int k = i; k > 1 && ends[k] < ends[k - 1]; --k) std::swap(ends[k], ends[k - 1]);
  ends[n] = 1;

  const Vec3d p0(p[0]), normal = (Vec3d(p[1]) - p0).cross(Vec3d(p[2]) - p0);
  const auto distance = [&](double s) {
    return normal.dot(p0 - ray.origin_at(s)) / normal.dot(ray.direction_at(s));
  };
  int found = 0;
  for (int i = 0; i < n; ++i) {
    const double lo = ends[i], hi = ends[i + 1], middle = 0.5 * (lo + hi);
    // A shorter stretch holds no sample, and its slope would not be finite.
    if (!(hi - lo > 0x1p-40)) continue;
    const Vec3d o = ray.origin_at(middle), d = ray.direction_at(middle);
    const Vec3d q[3] = {Vec3d(p[0]) - o, Vec3d(p[1]) - o, Vec3d(p[2]) - o};
    const double s0 = d.dot(q[0].cross(q[1])), s1 = d.dot(q[1].cross(q[2])), s2 = d.dot(q[2].cross(q[0]));
    const bool inside = (s0 > 0 && s1 > 0 && s2 > 0) || (s0 < 0 && s1 < 0 && s2 < 0);
    if (!inside || !(distance(middle) > 0)) continue;
    const TimeCover cover{lo, hi, std::max(distance(lo), 0.0), std::max(distance(hi), 0.0)};
    if (std::isfinite(cover.at_lo) && std::isfinite(cover.at_hi)) covers[found++] = cover;
  }
  return found;
}

SweptBoxes::SweptBoxes(const SweptRay& ray, const LineTree& tree) {
  const Vec3d o = ray.origin_at(0.5) - tree.centre, d = ray.direction_at(0.5);
  const Vec3d shift = ray.origin[1] - ray.origin[0], turn = ray.direction[1] - ray.direction[0];
  depth_ = d / d.length2();
  // The sweep is taken where the ray passes the tree's middle: there the turn widens least.
  pivot_ = std::max(0.0, -depth_.dot(o));
  const Vec3d sweep = shift + turn * pivot_;
  Vec3d along = sweep - d * depth_.dot(sweep);
  if (!(along.length2() > 0x1p-80 * sweep.length2())) along = any_across(d);
  along_ = along.normalized();
  across_ = d.cross(along_).normalized();
  across_o_ = across_.dot(o), along_o_ = along_.dot(o), depth_o_ = depth_.dot(o);
  sweep_ = along_.dot(sweep);
  across_turn_ = 0.5 * std::abs(across_.dot(turn));
  along_turn_ = 0.5 * std::abs(along_.dot(turn));
  depth_shift_ = 0.5 * std::abs(depth_.dot(shift));
  depth_turn_ = std::min(0.5 * std::abs(depth_.dot(turn)), 0.5);
}

void SweptBoxes::test(const LineNode& node, Met& out) const {
  std::fill(out.met, out.met + kWidth, false);
  for (int lane = 0; lane < kWidth; ++lane) {
    if (!(node.lo[0][lane] <= node.hi[0][lane])) break;  // unused, as all that follow
    const Range depth = range_of(depth_, node, lane), across = range_of(across_, node, lane),
                along = range_of(along_, node, lane);
    const double near = depth.middle - depth_o_ - depth.half - depth_shift_;
    const double far = (depth.middle - depth_o_ + depth.half + depth_shift_) / (1 - depth_turn_);
    const double distance = std::max(near / (1 + depth_turn_), 0.0);
    const double turned = std::max(std::abs(distance - pivot_), std::abs(far - pivot_));
    const double aside = std::abs(across.middle - across_o_) - across.half - across_turn_ * turned;
    const double reach = along.half + along_turn_ * turned, middle = along.middle - along_o_;
    // (s − ½) sweep_ lies in middle ± reach. Without a sweep a quotient is infinite, or NaN for 0 / 0: all
    // times.
    double lo = 0.5 + (middle - reach) / sweep_, hi = 0.5 + (middle + reach) / sweep_;
    if (lo > hi) std::swap(lo, hi);
    const bool at_all_times = std::isnan(lo) || std::isnan(hi);
    out.lo[lane] = at_all_times ? 0 : std::max(lo, 0.0);
    out.hi[lane] = at_all_times ? 1 : std::min(hi, 1.0);
    out.distance[lane] = distance;
    out.met[lane] = far >= 0 && aside <= 0 && out.lo[lane] <= out.hi[lane];
  }
}

}  // namespace penumbra
