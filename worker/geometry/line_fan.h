#pragma once
// The planar fan of segments from x to the chord a→b, set up once per query and tree, and what one
// triangle hides of it: the definition that every path (scalar, AVX2, AVX-512) follows bit for bit.
//
// With A = a-x, B = b-x, N = A×B and q = p-x for a point p, the fan's own coordinates are (numerics:
// FORMULAS.md §4; derived by solving q = s A + r B for a q in the plane, t = s+r, v = r/(s+r)):
//   g = N·q                side of the fan's plane
//   β = (N×A)·q            = r |N|²
//   t = (N×(A-B))·q        = (s+r) |N|², so t = |N|² on the light's line and 0 at x
//   v = β/t                where the ray x→p meets the chord
// Everything is scaled by powers of two only, so that predicates on small dyadic inputs stay exact.
#include <cstdint>
#include <limits>

#include "scenes/math.h"
#include "worker/geometry/intervals.h"
#include "worker/geometry/light_plane.h"

namespace penumbra {

struct LineFan {
  // Single precision: what vectors compute with.
  Vec3f x, g, beta, t;          ///< functionals of p - x
  float light_near, light_far;  ///< t is before the light below the one, beyond it from the other on
  float near;                   ///< |t| below this is decided in double precision (see set_up)
  float error;                  ///< bound of the rounding errors of where an edge crosses the plane

  // Double precision: the same fan for the few edges that need it.
  Vec3d x_exact, a, b;  ///< a, b relative to x
  Vec3d g_exact, beta_exact, t_exact;
  double light;     ///< t on the light's line
  Vec3d plane;      ///< normal of the light's plane, any length; 0: not known. Measured along it:
  double height;    ///< of x over that plane
  double rounding;  ///< by which the light's points may be off their plane
  double slack;     ///< length by which boxes are widened, so that no rounding of the above is culled
  bool degenerate;  ///< x, a and b are collinear: the fan has no area
};

/// Fan of (x, x+a, x+b) in the coordinates of one tree. `reach`: no vertex is farther from x than this.
/// `plane`: of the light, in the same coordinates; not known: the plane across the fan.
void set_up(LineFan& fan, const Vec3d& x, const Vec3d& a, const Vec3d& b, double reach,
            const LightPlane& plane = {});
inline LineFan make_fan(const Vec3d& x, const Vec3d& a, const Vec3d& b, double reach,
                        const LightPlane& plane = {}) {
  LineFan fan;
  set_up(fan, x, a, b, reach, plane);
  return fan;
}

/// !make_fan(x, a, b, …).degenerate, for less.
bool has_area(const Vec3d& a, const Vec3d& b);

/// What triangle p hides: v in [lo,hi], clamped to [0,1]; lo >= hi if nothing. Neighbours that share an
/// edge answer with the same bits at that edge.
Interval hidden_by_triangle(const LineFan& fan, const Vec3f p[3]);

/// The part of hidden_by_triangle that needs double precision; all paths share it. `odd` is the vertex alone
/// on its side of the plane.
Interval hidden_near_ends(const LineFan& fan, const Vec3f p[3], int odd);

constexpr Interval kHidesNothing{std::numeric_limits<float>::infinity(),
                                 -std::numeric_limits<float>::infinity()};

}  // namespace penumbra
