#include "worker/lights/spherical_triangle.h"

#include <algorithm>
#include <cmath>

#include "worker/lights/plane_side.h"

namespace penumbra {
namespace {

/// Most of the solid angle lies near the nearest vertex: measured from there, offsets along an edge keep their
/// digits where they matter, and what cancels in sample() does so far out, in proportion to what is left there.
int nearest_vertex(const Vec3d& corner, const Vec3d& u, const Vec3d& v) {
  const double length2[3] = {corner.length2(), (corner + u).length2(), (corner + v).length2()};
  return static_cast<int>(std::min_element(length2, length2 + 3) - length2);
}

}  // namespace

SphericalTriangle::SphericalTriangle(const Vec3d& corner, const Vec3d& u, const Vec3d& v)
    : SphericalTriangle(corner, u, v, nearest_vertex(corner, u, v)) {}

SphericalTriangle::SphericalTriangle(const Vec3d& corner, const Vec3d& u, const Vec3d& v, int turn)
    : turn_(turn) {
  const Vec3d vertex[3] = {corner, corner + u, corner + v},
              next_edge[3] = {u, v - u, -v};  // from vertex i to the next
  const double length[3] = {vertex[0].length(), vertex[1].length(), vertex[2].length()};
  const int second = (turn_ + 1) % 3, third = (turn_ + 2) % 3;
  a_ = vertex[turn_];
  b_ = vertex[second];
  const Vec3d& c = vertex[third];
  edge_ = -next_edge[third];
  base_ = -next_edge[turn_];
  a_length_ = length[turn_];
  b_length_ = length[second];
  edge_length_ = edge_.length();
  // From the corner, whose offset from x is exact: the sums vertex + edge are not.
  const PlaneSide side = side_of_plane(-corner, u, v);
  normal_ = side.normal;
  determinant_ = side.distance * side.twice_area;
  const double ab = a_.dot(b_), bc = b_.dot(c), ca = c.dot(a_), c_length = length[third];
  sum_ = a_length_ * b_length_ + ab;
  slope_ = b_length_ * a_.dot(edge_) + a_length_ * b_.dot(edge_);
  // Van Oosterom & Strackee 1983: tan(Ω/2) = det / (|a||b||c| + (a·b)|c| + (b·c)|a| + (c·a)|b|).
  const double denominator = sum_ * c_length + bc * a_length_ + ca * b_length_;
  omega_ = determinant_ > 0 ? 2 * std::atan2(determinant_, denominator) : 0;
}

Vec2d SphericalTriangle::sample(const Vec2d& u) const {
  // 1. The point p = a + t e on edge a→c for which the triangle (a, b, p) has the solid angle σ = u Ω.
  // In tan(σ/2) = det(a,b,p)/(…) the numerator is t det(a,b,c) and only |p| is not linear in t:
  //   α t = γ (|a| + |p|),  γ = sin(σ/2) (|a||b| + a·b),  α = cos(σ/2) det − sin(σ/2) (|b| a·e + |a| b·e).
  // Squared and divided by t: t = 2γ (α|a| + γ a·e) / ((α − γ|e|)(α + γ|e|)).
  const double half = 0.5 * u.x * omega_, s = std::sin(half);
  const double gamma = s * sum_, alpha = std::cos(half) * determinant_ - s * slope_;
  const double numerator = 2 * gamma * (alpha * a_length_ + gamma * a_.dot(edge_));
  const double denominator = (alpha - gamma * edge_length_) * (alpha + gamma * edge_length_);
  // t is in [0,1]; rounding may leave it by a hair, or spoil the denominator where x all but touches the
  // edge.
  const double t = numerator < denominator ? std::max(numerator / denominator, 0.0) : 1.0;

  // 2. The point q = b + w (p − b) whose angle θ from b has 1 − cosθ = y m, where m = 1 − cos of the angle
  // between b and p, for the solid angle next to b grows with 1 − cosθ. With τ = tan(θ/2):
  //   w : 1−w = |b| sinθ : |p| sin(Θ−θ) = |b| τ : |p| m (1−y)(√g + √m τ) / ((2 − y m)(√m + √g τ)),  g = 2 −
  //   m.
  // Every term is positive. m = |b×p|²/(|b||p| (|b||p| + b·p)), and b × p = b × (p − b).
  const Vec3d p = a_ + t * edge_, to_p = base_ + t * edge_;
  const double p_length = p.length(), product = b_length_ * p_length;
  const double g = (product + b_.dot(p)) / product;
  const double m = std::min(b_.cross(to_p).length2() / (product * product * g), 2.0);
  const double y = u.y, tau = std::sqrt(y * m / (2 - y * m)), root_m = std::sqrt(m), root_g = std::sqrt(g);
  const double near = b_length_ * tau;
  const double far =
      p_length * m * (1 - y) * (root_g + root_m * tau) / ((2 - y * m) * (root_m + root_g * tau));
  const double w = near + far > 0 ? near / (near + far) : 0;

  // q = (1−w) b + w ((1−t) a + t c), in the order of the constructor.
  const double weights[3] = {w * (1 - t), 1 - w, w * t};
  return {weights[(4 - turn_) % 3], weights[(5 - turn_) % 3]};
}

}  // namespace penumbra
