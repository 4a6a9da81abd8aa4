#include "worker/geometry/bow_tie.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace penumbra {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// An end of a triangle's cut.
struct End {
  double r, k;
};

/// The part of a cut before the chord, nearer end first; false where there is none.
bool clip(End& near, End& far) {
  if (near.k < far.k) std::swap(near, far);
  if (far.k >= 1) return false;
  if (near.k > 1) {
    const double share = (1 - far.k) / (near.k - far.k);
    near = {far.r + share * (near.r - far.r), 1};
  }
  return true;
}

}  // namespace

BowTie make_bow_tie(const Vec3d& a, const Vec3d& b, const Vec3d& focus) {
  BowTie tie;
  tie.focus = focus;
  const Vec3d A = a - focus, B = b - focus, n = A.cross(B);
  const double n2 = n.length2();
  if (!(n2 >= std::numeric_limits<double>::min()) || std::isinf(n2)) return tie;
  tie.side = n;
  tie.r = n.cross(A) / n2;
  tie.k = n.cross(A - B) / n2;
  tie.degenerate = !std::isfinite(tie.r.length2()) || !std::isfinite(tie.k.length2());
  return tie;
}

int cut_by_triangle(const BowTie& tie, const Vec3f p[3], CutPiece pieces[2]) {
  double side[3];
  Vec3d q[3];
  bool below[3];
  for (int i = 0; i < 3; ++i) {
    q[i] = Vec3d(p[i]) - tie.focus;
    side[i] = tie.side.dot(q[i]);
    below[i] = side[i] < 0;  // a vertex in the plane counts as above: coplanar triangles drop out
  }
  const bool differs1 = below[0] != below[1], differs2 = below[0] != below[2];
  if (!differs1 && !differs2) return 0;
  const int odd = differs1 && differs2 ? 0 : differs1 ? 1 : 2;
  // Symmetric in the edge's vertices to the last bit (no fused multiply-add), so that neighbours agree.
  const auto cross = [&](int i) {
    const double w = std::abs(side[i]), w_odd = std::abs(side[odd]), sum = w + w_odd;
    return End{(w * tie.r.dot(q[odd]) + w_odd * tie.r.dot(q[i])) / sum,
               (w * tie.k.dot(q[odd]) + w_odd * tie.k.dot(q[i])) / sum};
  };
  End near = cross(odd == 0 ? 1 : 0), far = cross(odd == 2 ? 1 : 2);
  if (!clip(near, far)) return 0;

  // The cut's line, r (k2−k1) − k (r2−r1) = d, has 1/k = (v (k2−k1) − (r2−r1)) / d. d vanishes where it
  // passes through the focus: then it is known to no more than the roundings of its products, and either sign
  // is right, for the surface covers the whole chord, partly just before the focus and partly just beyond it.
  const double products[2] = {near.r * far.k, far.r * near.k};
  const double doubt =
      std::numeric_limits<double>::epsilon() * (std::abs(products[0]) + std::abs(products[1]));
  double d = products[0] - products[1];
  if (std::abs(d) < doubt) d = std::copysign(doubt, d);
  const double slope = (far.k - near.k) / d, start = (near.r - far.r) / d;
  if (!std::isfinite(slope) || !std::isfinite(start)) return 0;

  // On its way through k = 0 the cut runs off to v = ±∞, and comes back from the other side.
  const double turn = std::copysign(kInfinity, -d);
  int n = 0;
  const auto add = [&](double v1, double v2, bool beyond) {
    const double lo = std::max(std::min(v1, v2), 0.), hi = std::min(std::max(v1, v2), 1.);
    if (lo < hi) pieces[n++] = {lo, hi, start, slope, beyond};
  };
  if (near.k > 0 && !tie.from_focus) add(near.r / near.k, far.k > 0 ? far.r / far.k : turn, false);
  if (far.k < 0) add(near.k < 0 ? near.r / near.k : -turn, far.r / far.k, true);
  return n;
}

}  // namespace penumbra
