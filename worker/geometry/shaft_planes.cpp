#include "worker/geometry/shaft_planes.h"

#include <algorithm>
#include <cmath>

#include "worker/geometry/line_fan.h"

namespace penumbra {
namespace {

double norm1(const Vec3d& v) {
  return std::abs(v.x) + std::abs(v.y) + std::abs(v.z);
}

/// Half-space n·q + offset >= 0, scaled so that |n|₁ = 1, and widened by `slack`.
ShaftFace face_of(const Vec3d& n, double scale, double offset, double slack) {
  return {Vec3f(n * scale), static_cast<float>(offset * scale + slack)};
}

/// Sides thinner than this, as a share of the farthest corner's squared distance, have a direction that
/// double precision (2⁻⁵³ of that square, a few times) does not give to the 2⁻²⁵ of single precision.
constexpr double kThinnestSide = 0x1p-25;

}  // namespace

LightPolygon LightPolygon::of(const std::array<Vec3d, 4>& corners, PrimitiveId light,
                              uint32_t light_primitives) {
  LightPolygon polygon;
  polygon.corners = corners;
  polygon.normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
  polygon.normal /= polygon.normal.length();
  polygon.normal_scale = 1 / norm1(polygon.normal);
  for (const Vec3d& c : corners)
    for (int k = 0; k < 3; ++k) polygon.largest = std::max(polygon.largest, std::abs(c[k]));
  polygon.light = light;
  polygon.light_primitives = light_primitives;
  return polygon;
}

LightPolygon LightPolygon::quad(const Vec3f& o, const Vec3f& u, const Vec3f& v, PrimitiveId light,
                                uint32_t light_primitives) {
  const Vec3d p(o), a(u), b(v);
  return of({p, p + a, p + a + b, p + b}, light, light_primitives);
}

LightPolygon LightPolygon::triangle(const Vec3f& p0, const Vec3f& p1, const Vec3f& p2, PrimitiveId light,
                                    uint32_t light_primitives) {
  return of({Vec3d(p0), Vec3d(p1), Vec3d(p2), Vec3d(p2)}, light, light_primitives);
}

// The slack: how far beside the pyramid (x, light) can a triangle lie and still hide something from a chord
// of the light? Let F be the distance of the farthest corner, H the height of x over the light's plane.
//
// 1. hidden_by_triangle computes g = N·q, β = (N×A)·q and t = (N×(A-B))·q of each vertex, each to within
//    5 u |c|₁ reach of its coefficients c (line_fan.cpp: 3 roundings of products and sums, 1 of c, 1 of q);
//    |c|₁ <= √3 |c|. So what it computes is exact for a vertex that is moved by at most e = 5√3 u reach in
//    each of three directions: along N, and in the fan's plane across A and across the chord.
// 2. Where an edge crosses the plane: (g β' + g' β) / (g + g') has three more roundings, of terms that are no
//    larger than |N×A| reach; the same for t. That moves the crossing by 3 u reach in the last two
//    directions.
// 3. What is off by d across A and by d across the chord is off by no more than 2d / sin(A, chord) in the
// plane.
//    The sine is the distance of x from the chord's line over |A|: at least H / F. Together with e along N
//    that is less than 3 (5√3 + 3) u reach F/H < 36 u reach F/H. The same for B, whose sine has the same
//    bound.
// 4. The quotient β/t and the thresholds `near` and `light`: one rounding each, u F along the chord and u
// reach
//    across it; crossings near x are decided in double.
// 5. Boxes and triangles are held against the faces in single precision, with |n|₁ = 1: 1 rounding of n, 1 of
// the
//    offset; triangles 1 of q and 3 of products and sums; boxes, relative to the tree's centre, 3 for x
//    there, 3 for the face's value at it and 3 for the sum. kThinnestSide keeps the side's direction to
//    another u. At most 12 u reach.
// In all less than 56 u reach F/H, since F >= H. The factor is 128: what double precision adds, a few 2^-53
// of the same lengths over sines no smaller than H/F, is far below the rest, for F/H < 2^20 (the test of the
// height).
//
// What the query itself is off by does not grow with reach: `rounding`, in u (largest + F), largest being
// that of the light's coordinates. A chord's ends are rounded to single precision: √3. The direction of a
// shadow ray: √3 of F. What lies before the light by less than LightApproach::hides counts is not before it:
// √3 (1 + 2·2) for the light's vertices and edges, √3 · √3 for x's share in the coordinates of what is met
// (|v| <= |x| + reach, |x| <= √3 largest + F), whose other share, √3 u reach, is in the 128. Sum: below 16.
void set_up(ShaftPlanes& s, const ShaftQuery& query, double reach) {
  const LightPolygon& light = *query.light;
  s.usable = false;
  s.face_count = 0;
  s.x = query.x;
  s.x_exact = Vec3d(query.x);
  for (int i = 0; i < 4; ++i) s.corners[i] = light.corners[i] - s.x_exact;
  const double height = -(light.normal ^ s.corners[0]);
  if (!(height > 0)) return;
  double farthest2 = 0;
  Vec3f lo(0, 0, 0), hi(0, 0, 0), sum(0, 0, 0);
  for (int i = 0; i < 4; ++i) {
    farthest2 = std::max(farthest2, s.corners[i].length2());
    const Vec3f a = s.corners_single[i] = Vec3f(s.corners[i]);
    sum += a;
    for (int k = 0; k < 3; ++k) lo[k] = std::min(lo[k], a[k]), hi[k] = std::max(hi[k], a[k]);
  }
  s.farthest = std::sqrt(farthest2);
  s.middle = sum * 0.25f;
  const double rounding = 16 * kFloatRoundoff * (light.largest + s.farthest);
  s.height = height - rounding;
  if (!(s.height > rounding)) return;
  s.slack = 128 * kFloatRoundoff * reach * (s.farthest / s.height) + rounding;
  for (int i = 0; i < 4; ++i) {
    const Vec3d &from = s.corners[i], &to = s.corners[(i + 1) % 4];
    if (from == to) continue;  // a triangle has no fourth side
    const Vec3d n = to.cross(from);
    const double size = norm1(n);
    if (!(size > kThinnestSide * farthest2)) return;
    s.faces[s.face_count++] = face_of(n, 1 / size, 0, s.slack);
  }
  s.faces[s.face_count++] = face_of(light.normal, light.normal_scale, height, s.slack);
  if (query.horizon != Vec3f(0, 0, 0))
    s.faces[s.face_count++] = face_of(Vec3d(query.horizon), 1 / norm1(Vec3d(query.horizon)), 0, s.slack);
  const Vec3f slack(static_cast<float>(s.slack));
  s.lo = lo - slack;
  s.hi = hi + slack;
  s.usable = true;
}

bool ShaftPlanes::plane_clears(const Vec3f p[3]) const {
  const Vec3d q = Vec3d(p[0]) - x_exact, e1 = Vec3d(p[1]) - Vec3d(p[0]), e2 = Vec3d(p[2]) - Vec3d(p[0]);
  const Vec3d n = e1.cross(e2);
  const double h = -(n ^ q);  // of x over the plane, times |n|
  const double side = h < 0 ? -1 : 1;
  // The products and sums of n·q round by a few 2⁻⁵³ of |e1| |e2| |q|.
  const double size = n.length();
  if (!(std::abs(h) > 0x1p-48 * norm1(e1) * norm1(e2) * norm1(q))) return false;
  double lowest = side * (n ^ corners[0]);
  for (int i = 1; i < 4; ++i) lowest = std::min(lowest, side * (n ^ corners[i]));
  if (lowest >= 0x1p-6 * farthest * size) return true;
  const double least = slack * size;
  return std::abs(h) > least && std::abs(h) + lowest > least;
}

bool ShaftPlanes::covered_by(const Vec3f p[3]) const {
  Vec3d q[3];
  for (int i = 0; i < 3; ++i) q[i] = Vec3d(p[i]) - x_exact;
  const Vec3d e1 = q[1] - q[0], e2 = q[2] - q[0];
  Vec3d n = e1.cross(e2);
  double h = n ^ q[0];
  const double turn = h < 0 ? -1 : 1;  // seen from x: clockwise or not
  n *= turn, h *= turn;
  constexpr double kNoise = 64 * kFloatRoundoff;  // Embree's roundings; see the derivation above
  const double edges = norm1(e1) * norm1(e2);
  if (!(h > kNoise * edges * norm1(q[0]))) return false;
  double along[4];  // x → corner meets the plane at h/along of its length
  for (int i = 0; i < 4; ++i) {
    along[i] = n ^ corners[i];
    if (!((along[i] - h) * height > slack * along[i])) return false;
    if (!(along[i] - h > kNoise * edges * (norm1(corners[i]) + norm1(q[0])))) return false;
  }
  for (int j = 0; j < 3; ++j) {
    const Vec3d &from = q[j], &to = q[(j + 1) % 3];
    const Vec3d side = from.cross(to) * turn;
    const double room = slack * side.length();
    const double noise = kNoise * norm1(to - from) * (norm1(from) + norm1(to));
    for (int i = 0; i < 4; ++i) {
      const double inside = side ^ corners[i];
      if (!(inside * h > room * along[i])) return false;
      if (!(inside > noise * norm1(corners[i]))) return false;
    }
  }
  return true;
}

}  // namespace penumbra
