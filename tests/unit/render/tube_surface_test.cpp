#include "worker/render/tube_surface.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace penumbra {
namespace {

using Imath::V4f;

/// One straight tube, seen from all around.
struct OneTube {
  OneTube(double radius, double taper, double far_away, bool facing) {
    const auto f = [](double v) { return static_cast<float>(v); };
    tubes.points = {V4f(f(far_away), f(-far_away), f(0.3 * far_away), f(radius)),
                    V4f(f(far_away + 1), f(-far_away + 0.5), f(0.3 * far_away - 0.2), f(radius * taper))};
    tubes.us = {0.25f, 0.5f};
    tubes.segments = {0};
    tubes.facing = facing;
    const MeshInput inputs[] = {{&nothing, {}, true, &tubes}};
    geometry.emplace(*Geometry::build(inputs, {}, {}, 1));
  }
  TriangleMesh nothing;
  Tubes tubes;
  std::optional<Geometry> geometry;
};

class Draw {
 public:
  double signed_unit() { return uniform_(engine_); }
  Vec3d direction() {
    for (;;) {
      const Vec3d d(signed_unit(), signed_unit(), signed_unit());
      if (d.length2() < 1 && d.length2() > 0.01) return d.normalized();
    }
  }
  /// A ray at the middle of a tube, missing it sometimes.
  Ray ray(const Tubes& tubes) {
    const TubeAxis axis(tubes);
    const double radius = 0.5 * (tubes.points[0].w + tubes.points[1].w);
    const Vec3d aim = axis.c + axis.e * (0.5 + 0.45 * signed_unit()) + direction() * radius;
    const Vec3d d = direction();
    return {Vec3f(aim - d * (1 + radius * 5)), Vec3f(d), 0, 1e6f};
  }

 private:
  struct TubeAxis {
    explicit TubeAxis(const Tubes& t) : c(t.points[0].x, t.points[0].y, t.points[0].z) {
      e = Vec3d(t.points[1].x, t.points[1].y, t.points[1].z) - c;
    }
    Vec3d c, e;
  };
  std::mt19937_64 engine_{17};
  std::uniform_real_distribution<double> uniform_{-1, 1};
};

template <class Use>
void each_hit(const OneTube& one, Use use) {
  Draw draw;
  QueryCounters counters;
  int hits = 0;
  for (int i = 0; i < 3000; ++i) {
    const Ray ray = draw.ray(one.tubes);
    const auto hit = one.geometry->intersect(ray, counters);
    if (!hit) continue;
    ++hits;
    use(tube_surface_at(one.tubes, *hit, ray.direction), ray, *hit, draw);
  }
  EXPECT_GT(hits, 1000);
}

// Whatever leaves on the normal's side, or through the tube on the other one, meets nothing of it.
TEST(TubeSurface, AShadowRayLeavesItsOwnTube) {
  for (const bool facing : {false, true})
    for (const double radius : {0.2, 0.01, 3e-4})
      for (const double far_away : {0., 3., 100.})
        for (const double taper : {1., 0.5}) {
          if (radius < 1e-5 * far_away) continue;  // thinner than coordinates can tell
          const OneTube one(radius, taper, far_away, facing);
          QueryCounters counters;
          int own = 0, asked = 0;
          each_hit(one, [&](const SurfacePoint& point, const Ray&, const Hit& hit, Draw& draw) {
            Vec3f w(draw.direction());
            // A cone shades what leaves it by less than its opening; what goes into a cap stays in the tube.
            const double opening = radius * (1 - taper) / 1.13;
            if (std::abs(w.dot(point.ng)) < 2.1 * opening) return;
            if (!facing && !(hit.u > 0 && hit.u < 1) && w.dot(point.ng) < 0) return;
            ++asked;
            own += one.geometry->occluded(point.offset(w), point.offset(w) + w * 10.f, counters);
          });
          EXPECT_EQ(own, 0) << "of " << asked << " radius " << radius << " at " << far_away << " taper "
                            << taper << (facing ? " facing" : "");
        }
}

TEST(TubeSurface, IsAskedAtTheTimeOfItsRay) {
  for (const bool facing : {false, true}) {
    const OneTube one(0.05, 1, 0, facing);
    each_hit(one, [&](const SurfacePoint&, const Ray& ray, Hit hit, Draw&) {
      hit.time = 0.625f;
      EXPECT_EQ(tube_surface_at(one.tubes, hit, ray.direction).time, 0.625f);
    });
  }
}

TEST(TubeSurface, HasPbrtsParametersAndTheHairsOffset) {
  const OneTube one(0.05, 1, 0, false);
  const struct { Vec3d axis; } frame{Vec3d(1, 0.5, -0.2).normalized()};
  each_hit(one, [&](const SurfacePoint& point, const Ray& ray, const Hit& hit, Draw&) {
    if (!(hit.u > 0 && hit.u < 1)) return;  // a cap
    const Vec3d p(point.p), along = frame.axis * p.dot(frame.axis);
    EXPECT_NEAR((p - along).length(), 0.05, 1e-6) << "on the tube";
    EXPECT_NEAR(point.ng.dot(point.dpdu), 0, 1e-5);
    EXPECT_NEAR(point.uv.x, 0.25 + 0.25 * along.length() / std::sqrt(1.29), 1e-5);
    // The ray's distance from the axis, across the tube.
    const Vec3d across = Vec3d(ray.direction).cross(frame.axis).normalized();
    const double h = Vec3d(ray.origin).dot(across) / 0.05;
    EXPECT_NEAR(std::abs(2 * point.uv.y - 1), std::abs(h), 1e-3);
    EXPECT_GT(point.ng.dot(point.wo), 0);
    // Increasing v is along dpdv, which is where the tube's far side is seen from.
    EXPECT_LE((2 * point.uv.y - 1) * point.wo.dot(point.dpdv), 1e-9);
  });
}

TEST(TubeSurface, FlatOnesFaceTheRay) {
  const OneTube one(0.05, 1, 0, true);
  each_hit(one, [&](const SurfacePoint& point, const Ray&, const Hit&, Draw&) {
    EXPECT_NEAR(point.ng.dot(point.dpdu), 0, 1e-5);
    const Vec3f t = point.dpdu.normalized();
    EXPECT_NEAR(point.ng.dot((point.wo - t * t.dot(point.wo)).normalized()), 1, 1e-5);
  });
}

TEST(TubeSurface, TangentsDoNotJumpAtJoints) {
  Tubes bent;
  bent.points = {V4f(0, 0, 0, 0.01f), V4f(1, 0, 0, 0.01f), V4f(2, 0.5f, 0, 0.01f)};
  bent.us = {0, 0.5f, 1};
  bent.segments = {0, 1};
  Hit before, after;
  before.id = {kNone, 0, 0}, after.id = {kNone, 0, 1};
  before.u = 1 - 1e-6f, after.u = 1e-6f;
  before.v = after.v = 0.3f;
  const Vec3f direction(0, 0, -1);
  const Vec3f a = tube_surface_at(bent, before, direction).dpdu,
              b = tube_surface_at(bent, after, direction).dpdu;
  EXPECT_NEAR(a.normalized().dot(b.normalized()), 1, 1e-6);
  before.u = 0;
  EXPECT_NEAR(tube_surface_at(bent, before, direction).dpdu.normalized().dot(Vec3f(1, 0, 0)), 1, 1e-6);
}

}  // namespace
}  // namespace penumbra
