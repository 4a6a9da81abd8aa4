#include "worker/lights/moving_light.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "worker/geometry/light_plane.h"

namespace penumbra {
namespace {

struct Mover {
  const Matrix& m;

  Vec3d point(const Vec3f& p) const {
    Vec3d out;
    m.multVecMatrix(Vec3d(p), out);
    return out;
  }
  Vec3d direction(const Vec3f& d) const {
    Vec3d out;
    m.multDirMatrix(Vec3d(d), out);
    return out;
  }
  /// Of a similarity.
  float scale() const { return float(Vec3d(m[0][0], m[0][1], m[0][2]).length()); }

  LightShape operator()(const QuadShape& q) const {
    return QuadShape{Vec3f(point(q.o)), Vec3f(direction(q.u)), Vec3f(direction(q.v))};
  }
  LightShape operator()(const TriangleShape& t) const {
    return TriangleShape{Vec3f(point(t.p0)), Vec3f(point(t.p1)), Vec3f(point(t.p2))};
  }
  LightShape operator()(const SphereShape& s) const {
    return SphereShape{Vec3f(point(s.center)), s.radius * scale(), s.inwards};
  }
  LightShape operator()(const DiskShape& d) const {
    return DiskShape{Vec3f(point(d.center)), Vec3f(direction(d.n).normalized()), d.radius * scale(),
                     d.inner * scale()};
  }
  LightShape operator()(const CylinderShape& c) const {
    return CylinderShape{Vec3f(point(c.base)), Vec3f(direction(c.axis)), c.radius * scale(), c.inwards};
  }
};

/// As Geometry::place_of() has it for what stands: twice the extents, and the largest coordinates.
double rounding_of(const LightShape& shape) {
  const LightBounds box = bounds_of(AreaEmitter{shape, Rgb(0)});
  Vec3d own = (box.hi - box.lo) * 2;
  for (int k = 0; k < 3; ++k) own[k] += std::max(std::abs(box.lo[k]), std::abs(box.hi[k]));
  return rounding_along(emission_normal(shape, box.lo), own);
}

}  // namespace

LightShape moved(const LightShape& shape, const Matrix& to_world) {
  return std::visit(Mover{to_world}, shape);
}

AreaEmitter standing_at(const AreaEmitter& emitter, double u) {
  AreaEmitter now = emitter;
  now.shape = moved(emitter.motion->in_object, emitter.motion->to_world.at(u));
  if (now.flat) now.rounding = rounding_of(now.shape);
  now.crowded = true;
  return now;
}

LightBounds bounds_of_moving(const AreaEmitter& emitter) {
  const LightMotion& motion = *emitter.motion;
  const LightBounds object = bounds_of(AreaEmitter{motion.in_object, Rgb(0)});
  LightBounds all;
  bool first = true;
  for (const MovedBox& box : motion.to_world.boxes({object.lo, object.hi})) {
    for (int k = 0; k < 3; ++k) {
      all.lo[k] = first ? box.lo[k] : std::min(all.lo[k], box.lo[k]);
      all.hi[k] = first ? box.hi[k] : std::max(all.hi[k], box.hi[k]);
    }
    first = false;
  }
  all.normals.cos_spread = -1;
  // An estimate, for drawing among lights: the largest of some times.
  for (const double u : {0., 0.25, 0.5, 0.75, 1.})
    all.power = std::max(all.power,
                         luminance(emitter.radiance) * area(moved(motion.in_object, motion.to_world.at(u))));
  return all;
}

}  // namespace penumbra
