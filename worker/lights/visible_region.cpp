#include "worker/lights/visible_region.h"

#include <algorithm>
#include <cmath>

#include "proto/status.h"
#include "worker/lights/plane_side.h"

namespace penumbra {
namespace {

constexpr double kRoundoff = 0x1p-53;
/// Pieces smaller than this part of the light are what roundings leave where two edges meet: a corner is
/// right to some 2⁻⁵⁰ of the light's size, so that what opens between two copies of it has the square of
/// that.
constexpr double kSmallestPiece = 0x1p-64;
/// Less than this in a shadow does not make it worth a cut; many such together are still no piece.
constexpr double kSmallestCut = 0x1p-80;
/// No piece as narrow as a line's rounding is larger.
constexpr double kNarrowPiece = 0x1p-40;
/// Of a vertex in single precision: occluders nearer to the light's plane than its roundings and theirs do
/// not count, as for lines and for the ends of shadow segments (geometry: light_plane.h).
constexpr double kVertexRoundoff = 0x1p-24;

double norm1(const Vec3d& v) {
  return std::abs(v.x) + std::abs(v.y) + std::abs(v.z);
}

double cross(const Vec2d& a, const Vec2d& b) {
  return a.x * b.y - a.y * b.x;
}

bool comes_first(const Vec3d& a, const Vec3d& b) {
  return a.x != b.x ? a.x < b.x : a.y != b.y ? a.y < b.y : a.z < b.z;
}

}  // namespace

double VisibleRegion::Polygon::area() const {
  double twice = 0;
  for (int i = 2; i < size; ++i) twice += cross(corners[i - 1] - corners[0], corners[i] - corners[0]);
  return 0.5 * twice;
}

bool VisibleRegion::Polygon::add(const Vec2d& corner) {
  if (size == kMostCorners) return false;
  corners[size++] = corner;
  return true;
}

double VisibleRegion::Side::at(const Vec2d& corner) const {
  const double value = n.x + n.y * corner.x + n.z * corner.y;
  return std::abs(value) > rounding ? value : 0;
}

void VisibleRegion::clear() {
  pieces_.clear();
  patches_.clear();
  whole_ = false;
}

void VisibleRegion::reset(const LightShape& shape, const Vec3d& x, const Vec3d& horizon, double rounding) {
  clear();
  x_ = x;
  Polygon all;
  if (const auto* quad = std::get_if<QuadShape>(&shape)) {
    o_ = Vec3d(quad->o) - x;
    u_ = Vec3d(quad->u);
    v_ = Vec3d(quad->v);
    for (const Vec2d& c : {Vec2d(0, 0), Vec2d(1, 0), Vec2d(1, 1), Vec2d(0, 1)}) all.add(c);
  } else {
    const auto& triangle = std::get<TriangleShape>(shape);
    o_ = Vec3d(triangle.p0) - x;
    u_ = Vec3d(triangle.p1) - Vec3d(triangle.p0);
    v_ = Vec3d(triangle.p2) - Vec3d(triangle.p0);
    for (const Vec2d& c : {Vec2d(0, 0), Vec2d(1, 0), Vec2d(0, 1)}) all.add(c);
  }
  across_ = u_.cross(v_);
  full_area_ = all.area();
  const PlaneSide side = side_of_plane(-o_, u_, v_);
  if (!(side.distance > 0)) return;
  depth_ = side.distance * side.twice_area;
  rounding_ = rounding * side.twice_area;
  Polygon above, below;
  const double sure = 8 * kRoundoff * norm1(horizon) * (norm1(o_) + norm1(u_) + norm1(v_));
  // All of it above where there is no horizon: every corner is at 0.
  split(all, side_of(horizon, sure), above, below);
  whole_ = below.size == 0;
  if (above.area() > kSmallestPiece) pieces_.push_back(above);
}

VisibleRegion::Side VisibleRegion::side_of(const Vec3d& n, double rounding) const {
  return {Vec3d(n.dot(o_), n.dot(u_), n.dot(v_)), rounding};
}

VisibleRegion::Side VisibleRegion::side_along(const Vec3d& from, const Vec3d& to, double turn) const {
  // Both triangles of an edge get the same bits but for the sign: what one takes for on the line is so for
  // the other.
  const bool forth = comes_first(from, to);
  const Vec3d &a = forth ? from : to, &b = forth ? to : from, along = b - a;
  // The product's components are right to a few roundings of |a| |b − a|, and so is its part along o, u and
  // v.
  const double rounding = 32 * kRoundoff * norm1(a) * norm1(along) * (norm1(o_) + norm1(u_) + norm1(v_));
  return side_of(a.cross(along) * (forth == (turn > 0) ? 1 : -1), rounding);
}

bool VisibleRegion::subtract(const std::array<Vec3f, 3>& triangle) {
  if (pieces_.empty()) return true;
  Vec3d q[3];
  for (int i = 0; i < 3; ++i) q[i] = Vec3d(triangle[i]) - x_;
  const Vec3d e1 = q[1] - q[0], e2 = q[2] - q[0];
  const double turn = q[0].dot(e1.cross(e2));
  // Edge on: it hides nothing.
  if (!(std::abs(turn) > 8 * kRoundoff * norm1(q[0]) * norm1(e1) * norm1(e2))) return true;

  // Only what lies before the light's plane hides; its shadow is the cone over that part, an intersection of
  // half-spaces through x wherever its corners are.
  double depth[3];
  int far = 0;
  for (int i = 0; i < 3; ++i) {
    double own = 0;
    for (int k = 0; k < 3; ++k) own += std::abs(across_[k] * double(triangle[size_t(i)][k]));
    // > 0: before the light. By each vertex's own rounding, so that the triangles of an edge cut it alike.
    depth[i] = depth_ + across_.dot(q[i]) - (rounding_ + kVertexRoundoff * own);
    if (!(depth[i] > 0)) ++far;
  }
  if (far == 3) return true;
  std::array<Side, 4> shadow;
  int sides = 0;
  for (int i = 0; i < 3; ++i) shadow[sides++] = side_along(q[i], q[(i + 1) % 3], turn);
  if (far > 0) {
    Vec3d cut[2];
    int cuts = 0, inner = 0;
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3;
      if (depth[i] > depth[inner]) inner = i;
      if ((depth[i] > 0) == (depth[j] > 0)) continue;
      cut[cuts++] = q[i] + depth[i] / (depth[i] - depth[j]) * (q[j] - q[i]);
    }
    shadow[sides++] = side_along(cut[0], cut[1], cut[0].cross(cut[1] - cut[0]).dot(q[inner]));
  }

  before_.swap(pieces_);
  pieces_.clear();
  for (const Polygon& piece : before_)
    if (!subtract(piece, {shadow.data(), size_t(sides)})) return false;
  return true;
}

/// What is left of a convex piece: outside the first side, inside the first and outside the second, …
bool VisibleRegion::subtract(const Polygon& piece, std::span<const Side> shadow) {
  for (const Side& side : shadow) {
    bool outside = true, on = true;
    for (const Vec2d& c : piece.all()) {
      const double at = side.at(c);
      outside &= at <= 0;
      on &= at == 0;
    }
    // Narrower than the rounding of the line that it lies on: it is outside both triangles of that edge.
    if (on && piece.area() < kNarrowPiece) return true;
    if (outside) return keep(piece);
  }
  const size_t others = pieces_.size();
  Polygon rest = piece;
  for (const Side& side : shadow) {
    Polygon inside, outside;
    if (!split(rest, side, inside, outside)) return false;
    if (!(inside.area() > kSmallestCut)) {
      // The shadow passes by: no need to have cut.
      pieces_.resize(others);
      return keep(piece);
    }
    if (outside.area() > kSmallestPiece && !keep(outside)) return false;
    rest = inside;
  }
  whole_ = false;
  return true;
}

bool VisibleRegion::keep(const Polygon& piece) {
  if (pieces_.size() == size_t(kMostPieces)) return false;
  pieces_.push_back(piece);
  return true;
}

bool VisibleRegion::split(const Polygon& piece, const Side& side, Polygon& inside, Polygon& outside) {
  double at[Polygon::kMostCorners];
  bool leaves = false;
  for (int i = 0; i < piece.size; ++i) leaves |= (at[i] = side.at(piece.corners[i])) < 0;
  if (!leaves) {
    inside = piece;
    return true;
  }
  for (int i = 0; i < piece.size; ++i) {
    const int next = i + 1 < piece.size ? i + 1 : 0;
    const Vec2d &a = piece.corners[i], &b = piece.corners[next];
    if (at[i] >= 0 && !inside.add(a)) return false;
    if (at[i] <= 0 && !outside.add(a)) return false;
    if (!((at[i] > 0 && at[next] < 0) || (at[i] < 0 && at[next] > 0))) continue;
    // Of opposite signs: nothing cancels.
    const Vec2d crossing = a + (b - a) * (at[i] / (at[i] - at[next]));
    if (!inside.add(crossing) || !outside.add(crossing)) return false;
  }
  return true;
}

double VisibleRegion::area_fraction() const {
  double sum = 0;
  for (const Polygon& piece : pieces_) sum += piece.area();
  return sum / full_area_;
}

void VisibleRegion::finish() {
  patches_.clear();
  double sum = 0;
  for (const Polygon& piece : pieces_) {
    const Vec2d& c = piece.corners[0];
    const Vec3d corner = o_ + (u_ * c.x + v_ * c.y);
    const auto edge_to = [&](int i) {
      const Vec2d d = piece.corners[i] - c;
      return u_ * d.x + v_ * d.y;
    };
    // All triangles of a piece are one continuous map: strata stay whole.
    Vec3d edge = edge_to(piece.size - 1);
    for (int i = piece.size - 2; i > 0; --i) {
      const Vec3d next = edge_to(i);
      Patch patch{SphericalTriangle::about_corner(corner, next, edge), corner, next, edge, 0};
      edge = next;
      if (!(patch.seen.solid_angle() > 0)) continue;
      patch.up_to = sum += patch.seen.solid_angle();
      patches_.push_back(patch);
    }
  }
}

LightPoint VisibleRegion::sample(const Vec2d& u) const {
  if (patches_.empty()) return {};
  // A patch by its solid angle, and what is left of the random number within it.
  const double target = u.x * solid_angle();
  size_t i = 0;
  while (i + 1 < patches_.size() && !(target < patches_[i].up_to)) ++i;
  const Patch& patch = patches_[i];
  const double omega = patch.seen.solid_angle();
  const double rest = std::clamp((target - (patch.up_to - omega)) / omega, 0.0, 1 - kRoundoff);
  const Vec2d b = patch.seen.sample({rest, u.y});
  return {x_ + (patch.corner + (b.x * patch.u + b.y * patch.v)), across_.normalized(), 1 / solid_angle()};
}

double VisibleRegion::pdf(const Vec3d& p) const {
  return holds(p) && !patches_.empty() ? 1 / solid_angle() : 0;
}

bool VisibleRegion::holds(const Vec3d& p) const {
  // Where the ray from x through p meets the light: p itself, but for its rounding.
  const Vec3d d = p - x_;
  const double towards = -across_.dot(d);
  if (!(towards > 0)) return false;
  const Vec3d on = d * (depth_ / towards) - o_;
  const double scale = 1 / across_.length2();
  const Vec2d at(on.cross(v_).dot(across_) * scale, u_.cross(on).dot(across_) * scale);
  for (const Polygon& piece : pieces_) {
    bool inside = true;
    for (int i = 0; inside && i < piece.size; ++i) {
      const Vec2d &a = piece.corners[i], &b = piece.corners[i + 1 < piece.size ? i + 1 : 0];
      // Between two pieces must be no gap: a point of one is never outside both.
      inside = cross(b - a, at - a) >= -0x1p-40;
    }
    if (inside) return true;
  }
  return false;
}

}  // namespace penumbra
