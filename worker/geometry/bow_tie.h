#pragma once
// The planar bow-tie of the rays that leave a chord a→b and all pass through one point F, and what of one
// triangle they meet: for depth of field, a chord of the lens and the point in focus.
//
// With A = a−F, B = b−F and q = p−F for a point p of the plane, q = s A + r B. The ray of the chord's point
// P(v) = a + v (b−a) is F + k ((1−v) A + v B), k falling from 1 on the chord through 0 at F to −∞; so
//   k = s + r,   v = r / (s + r),
// the functionals of a line query's fan with F in x's place (line_fan.h). A triangle cuts the plane in a
// segment, and on its line 1/k is linear in v: segments stay segments in (v, 1/k), where the nearest surface
// is the lower envelope, before F (k > 0) and beyond it (k < 0) alike.
#include <cstdint>

#include "scenes/math.h"

namespace penumbra {

struct BowTie {
  Vec3d focus;
  Vec3d side, r, k;        ///< functionals of p − focus: distance from the plane (in any unit), r and k
  bool from_focus = false;  ///< what lies before the focus does not count
  bool degenerate = true;  ///< the chord is seen end on from the focus, or numbers would overflow
};

BowTie make_bow_tie(const Vec3d& a, const Vec3d& b, const Vec3d& focus);

/// A triangle's cut on one side of the focus, over the interval lo < hi of the chord: 1/k = start + slope v.
struct CutPiece {
  double lo = 0, hi = 0;
  double start = 0, slope = 0;
  bool beyond = false;  ///< the focus

  double inverse_depth(double v) const { return start + slope * v; }
};

/// What a triangle covers: one piece before the focus and one beyond it at most (a cut that passes the
/// focus's height has both). Returns how many; neighbours that share an edge end with the same bits there.
int cut_by_triangle(const BowTie& tie, const Vec3f p[3], CutPiece pieces[2]);

}  // namespace penumbra
