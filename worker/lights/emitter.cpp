#include "worker/lights/emitter.h"

namespace penumbra {
namespace {

DeltaLight from_position(const Vec3f& position, const Vec3f& x) {
  const Vec3d d = Vec3d(position) - Vec3d(x);
  const double distance = d.length();
  DeltaLight light{Vec3f(0), Rgb(0), position};
  // x on the light itself: no direction, and the inverse square has no value; nothing arrives.
  if (distance > 0) light.wi = Vec3f(d / distance);
  return light;
}

/// Inverse square law; 0 where the light and x coincide.
double inverse_square(const Vec3f& position, const Vec3f& x) {
  const double d2 = (Vec3d(position) - Vec3d(x)).length2();
  return d2 > 0 ? 1 / d2 : 0;
}

float spot_falloff(const SpotEmitter& spot, float cosine) {
  if (cosine <= spot.cos_outer) return 0;
  if (cosine >= spot.cos_inner) return 1;
  const float d = (cosine - spot.cos_outer) / (spot.cos_inner - spot.cos_outer);
  return d * d * d * d;
}

struct NormalAt {
  const Vec3d& p;

  Vec3d operator()(const QuadShape& q) const { return Vec3d(q.u).cross(Vec3d(q.v)).normalized(); }
  Vec3d operator()(const TriangleShape& t) const {
    const Vec3d p0(t.p0);
    return (Vec3d(t.p1) - p0).cross(Vec3d(t.p2) - p0).normalized();
  }
  Vec3d operator()(const SphereShape& s) const {
    const Vec3d out = (p - Vec3d(s.center)).normalized();
    return s.inwards ? -out : out;
  }
  Vec3d operator()(const DiskShape& d) const { return Vec3d(d.n); }
  Vec3d operator()(const CylinderShape& c) const {
    const Vec3d axis = Vec3d(c.axis).normalized(), from_base = p - Vec3d(c.base);
    const Vec3d out = (from_base - axis * from_base.dot(axis)).normalized();
    return c.inwards ? -out : out;
  }
};

struct At {
  const Vec3f& x;
  float reach;

  DeltaLight operator()(const PointEmitter& e) const {
    DeltaLight light = from_position(e.position, x);
    light.irradiance = e.intensity * float(inverse_square(e.position, x));
    return light;
  }
  DeltaLight operator()(const SpotEmitter& e) const {
    DeltaLight light = from_position(e.position, x);
    const float falloff = spot_falloff(e, -light.wi.dot(e.axis));
    light.irradiance = e.intensity * (falloff * float(inverse_square(e.position, x)));
    return light;
  }
  DeltaLight operator()(const DistantEmitter& e) const {
    return {e.towards_light, e.irradiance, x + e.towards_light * reach};
  }
};

}  // namespace

Vec3d emission_normal(const LightShape& shape, const Vec3d& p) {
  return std::visit(NormalAt{p}, shape);
}

bool behind_own_wall(const LightShape& shape, const Vec3d& on_light, const Vec3d& x) {
  if (const auto* sphere = std::get_if<SphereShape>(&shape))
    return sphere->inwards && (x - Vec3d(sphere->center)).length() > double{sphere->radius};
  const auto* tube = std::get_if<CylinderShape>(&shape);
  if (tube == nullptr || !tube->inwards) return false;
  const double height = Vec3d(tube->axis).length();
  const Vec3d axis = Vec3d(tube->axis) / height, way = x - on_light, from = on_light - Vec3d(tube->base);
  const Vec3d across = way - axis * way.dot(axis), start = from - axis * from.dot(axis);
  // From the wall at start the way meets the wall again at t: |start + t across| = |start|.
  const double t = across.length2() > 0 ? -2 * start.dot(across) / across.length2() : 2;
  const double there = from.dot(axis) + t * way.dot(axis);
  return t < 1 && there > 0 && there < height;
}

DeltaLight delta_light_at(const DeltaEmitter& emitter, const Vec3f& x, float reach) {
  return std::visit(At{x, reach}, emitter);
}

}  // namespace penumbra
