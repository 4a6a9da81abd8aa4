#pragma once
// A ray that moves: what of a triangle it meets when (Gribel, Doggett & Akenine-Möller 2010, for a ray that
// is fixed while vertices move: here the other way round, in the object's space), and which boxes it may
// meet.
//
// Origin and direction change linearly over s in [0,1]. The side on which it passes an edge is then a
// quadratic in s, so that its roots are all times at which an edge of the triangle crosses the ray.
#include "worker/geometry/line_bvh.h"

namespace penumbra {

struct SweptRay {
  Vec3d origin[2], direction[2];  ///< at s = 0 and 1

  Vec3d origin_at(double s) const { return origin[0] * (1 - s) + origin[1] * s; }
  Vec3d direction_at(double s) const { return direction[0] * (1 - s) + direction[1] * s; }
};

/// The ray meets a triangle from s = lo to hi, at distances `near` and `far` there, in lengths of its
/// direction.
struct TimeCover {
  double lo = 0, hi = 0;
  double at_lo = 0, at_hi = 0;
};
/// Three quadratics have six roots, and seven intervals between them.
constexpr int kMostCovers = 7;

/// Appends nothing but intervals of [0,1] of positive length, ascending; returns how many.
int covers_of_triangle(const SweptRay& ray, const Vec3f p[3], TimeCover covers[kMostCovers]);

/// What a moving ray may meet of sixteen boxes.
class SweptBoxes {
 public:
  SweptBoxes(const SweptRay& ray, const LineTree& tree);

  /// Of a lane that may be met: when, and no nearer than which distance. Rounding may lose a box at the rim,
  /// by parts of 2^-50 of the distances: what is found are times to look at, not what is seen there.
  struct Met {
    bool met[kWidth];
    double lo[kWidth], hi[kWidth], distance[kWidth];
  };
  void test(const LineNode& node, Met& out) const;

 private:
  // With the middle ray o + t d, Δ and δ the changes of origin and direction, a point that the ray meets at s
  // is o + t d + (s − ½)(Δ + t δ). `across_` is perpendicular to d and to the sweep Δ + pivot δ, `along_` to
  // d alone; depth_ measures t.
  Vec3d across_, along_, depth_;
  double across_o_ = 0, along_o_ = 0, depth_o_ = 0;  ///< of o, in the tree's coordinates
  double pivot_ = 0, sweep_ = 0;                     ///< along_ · (Δ + pivot δ)
  double across_turn_ = 0, along_turn_ = 0;          ///< ½ |across_ · δ|, ½ |along_ · δ|
  double depth_shift_ = 0, depth_turn_ = 0;          ///< ½ |depth_ · Δ|, ½ |depth_ · δ|
};

}  // namespace penumbra
