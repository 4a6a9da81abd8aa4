#pragma once
// One segment of a tube (scenes/curve.h): the convex hull of two balls, which is every ball whose centre and
// radius run linearly from the one to the other. Here is what a ray meets of it, where Embree has found that
// it does, and what a fan loses by it: one definition for points and lines. Double precision throughout.
#include <ImathVec.h>

#include "worker/geometry/geometry.h"
#include "worker/geometry/line_fan.h"

namespace penumbra {

struct TubeSegment {
  /// From the two points of Tubes::points that begin at p.
  explicit TubeSegment(const Imath::V4f* p)
      : c(p[0].x, p[0].y, p[0].z),
        e(Vec3d(p[1].x, p[1].y, p[1].z) - c),
        r(p[0].w),
        dr(double{p[1].w} - p[0].w),
        shape(e.length2() - dr * dr) {}

  Vec3d centre(double w) const { return c + e * w; }
  double radius(double w) const { return r + dr * w; }
  /// Neither ball holds the other: there is a side between them.
  bool has_side() const { return shape > 0; }

  Vec3d c, e;    ///< centre of the first ball; from there to the second's
  double r, dr;  ///< radius of the first; how much larger the second is
  double shape;  ///< |e|² - dr²
};

/// A point on a segment: the ball that it lies on, and the outward normal there.
struct TubePoint {
  double w = 0;
  Vec3d normal;
};

/// Where a ray meets a segment, next to the distance that Embree has found in single precision; hit.u and v
/// are set so that tube_point() gives the point back.
void refine(const TubeSegment& segment, const Ray& ray, Hit& hit);

/// Has the segment from x to y a point in common with the tube?
bool meets(const TubeSegment& segment, const Vec3d& x, const Vec3d& y);

/// The point of a hit. u runs along the segment from 0 to 1 on its side; on the first ball's cap it is
/// smaller, on the last one's larger, by how far the normal leans over there. v is the angle about the axis
/// over 2π.
TubePoint tube_point(const TubeSegment& segment, float u, float v);

/// A fan in the world, as tubes see it.
struct TubeFan {
  TubeFan(const Vec3d& x, const Vec3d& a, const Vec3d& b);
  Vec3d x, a, chord;  ///< a relative to x; chord = b - a
  Vec3d plane;        ///< unit normal of the fan's plane
  Vec3d t;            ///< t·q = 0 at x and 1 on the light's line, for q in the plane, relative to x
  double t_length;
};

/// What a segment hides of the chord: v in [lo,hi] within [0,1]; lo >= hi if nothing. Segments that share a
/// ball leave no gap there.
Interval hidden_by_tube(const TubeFan& fan, const TubeSegment& segment);

}  // namespace penumbra
