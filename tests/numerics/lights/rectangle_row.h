#pragma once
// The rectangle of a battery row as the product sees it.
#include "tests/numerics/csv.h"
#include "tests/numerics/worst_errors.h"
#include "worker/lights/line.h"
#include "worker/lights/shape.h"

namespace penumbra::numerics {

/// The battery's rectangles are seen from either side, the product's lights emit to one. A row seen from
/// behind is mirrored in x: exact in binary32, and it changes no distance, fraction or solid angle.
struct RectangleRow {
  explicit RectangleRow(const Row& row) : name(row.label()) {
    quad = {row.vector("s"), row.vector("ex"), row.vector("ey")};
    x = Vec3d(row.vector("p"));
    const Vec3d n = Vec3d(quad.u).cross(Vec3d(quad.v));
    mirrored = (x - Vec3d(quad.o)).dot(n) < 0;
    if (mirrored) {
      for (Vec3f* w : {&quad.o, &quad.u, &quad.v}) w->x = -w->x;
      x.x = -x.x;
    }
    shape = quad;
  }
  SphericalRectangle rectangle() const { return {Vec3d(quad.o) - x, Vec3d(quad.u), Vec3d(quad.v)}; }

  std::string name;
  QuadShape quad;
  LightShape shape;
  Vec3d x;
  bool mirrored = false;
};

}  // namespace penumbra::numerics
