// Solid angles and maps checked by other roads: triangles against rectangles, long double, powers of two.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "worker/lights/shape.h"
#include "worker/sampling/hash.h"
#include "worker/sampling/sampler.h"

namespace penumbra {
namespace {

double number(uint64_t i) {
  return 2 * uniform(mix64(i + 1)) - 1;
}
Vec3f vector(uint64_t i) {
  return {static_cast<float>(number(3 * i)), static_cast<float>(number(3 * i + 1)),
          static_cast<float>(number(3 * i + 2))};
}

long double reference(const TriangleShape& t, const Vec3d& x) {
  using V = Imath::Vec3<long double>;
  const V a = V(t.p0) - V(x), b = V(t.p1) - V(x), c = V(t.p2) - V(x);
  const long double la = std::sqrt(a.dot(a)), lb = std::sqrt(b.dot(b)), lc = std::sqrt(c.dot(c));
  return 2 * std::atan2(std::abs(a.dot((b - a).cross(c - a))),
                        la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
}

TEST(SphericalTriangle, AnOctantIsHalfPi) {
  const LightShape t = TriangleShape{{1, 0, 0}, {0, 0, 1}, {0, 1, 0}};
  EXPECT_NEAR(SeenShape(t, {0, 0, 0}).solid_angle(), std::numbers::pi / 2, 1e-15);
}

TEST(SphericalTriangle, AgreesWithLongDouble) {
  // Random, slivers (one corner 1e-6 from the opposite edge) and distances up to 1e6; either orientation.
  for (uint64_t i = 0; i < 2000; ++i) {
    TriangleShape t{vector(4 * i), vector(4 * i + 1), vector(4 * i + 2)};
    if (i % 3 == 1) t.p2 = 0.25f * t.p0 + 0.75f * t.p1 + 1e-6f * t.p2;
    const float far = i % 5 == 2 ? 1e6f : 1.5f;
    const Vec3d x(far * vector(4 * i + 3));
    const LightShape seen_from_front = t, seen_from_behind = TriangleShape{t.p0, t.p2, t.p1};
    const double omega =
        SeenShape(seen_from_front, x).solid_angle() + SeenShape(seen_from_behind, x).solid_angle();
    const long double expected = reference(t, x);
    // The plane's distance is the small difference of the offset's components: |offset|/distance digits go.
    const Vec3d n = Vec3d(t.p1 - t.p0).cross(Vec3d(t.p2 - t.p0)), d = x - Vec3d(t.p0);
    const double edges = Vec3d(t.p1 - t.p0).length() * Vec3d(t.p2 - t.p0).length();
    const double condition = 1 + d.length() * edges / std::abs(d.dot(n));
    EXPECT_NEAR(omega / expected, 1, 16 * 0x1p-53 * condition) << i;
  }
}

TEST(SphericalTriangle, TwoMakeTheRectangle) {
  for (uint64_t i = 0; i < 500; ++i) {
    // Edges along the axes, so that o + u has no rounding beyond a float's.
    const QuadShape q{{-1, -0.5f, 0}, {2, 0, 0}, {0, 1, 0}};
    Vec3d x(Vec3d(vector(i)) * std::pow(10, 3 * number(7 * i)));
    x.z = std::abs(x.z);
    const LightShape quad = q, first = TriangleShape{q.o, q.o + q.u, q.o + q.u + q.v},
                     second = TriangleShape{q.o, q.o + q.u + q.v, q.o + q.v};
    const double whole = SeenShape(quad, x).solid_angle();
    EXPECT_NEAR((SeenShape(first, x).solid_angle() + SeenShape(second, x).solid_angle()) / whole, 1,
                1e-14 * (1 + (1 + x.length()) / x.z))
        << i;
  }
}

TEST(SolidAngle, IsTheSameAtEveryScale) {
  // Scaled by a power of two nothing rounds differently: same bits, from 1e-27 to 1e27 units.
  for (uint64_t i = 0; i < 50; ++i) {
    QuadShape q{vector(3 * i), {1.5f, 0, 0.5f}, {-0.25f, 1, 0.75f}};
    TriangleShape t{vector(3 * i), vector(3 * i + 1), vector(3 * i + 2)};
    const Vec3f x = 3.0f * vector(3 * i + 7);
    for (const int exponent : {-90, -30, 30, 90}) {
      const float k = std::ldexp(1.0f, exponent);
      const LightShape quad = q, triangle = t, big_quad = QuadShape{k * q.o, k * q.u, k * q.v},
                       big_triangle = TriangleShape{k * t.p0, k * t.p1, k * t.p2};
      const SeenShape a(quad, Vec3d(x)), b(big_quad, Vec3d(k * x));
      EXPECT_EQ(a.solid_angle(), b.solid_angle());
      EXPECT_EQ(SeenShape(triangle, Vec3d(x)).solid_angle(),
                SeenShape(big_triangle, Vec3d(k * x)).solid_angle());
      if (a.solid_angle() > 0) {
        EXPECT_EQ(a.sample({0.3, 0.7}).p * static_cast<double>(k), b.sample({0.3, 0.7}).p);
      }
    }
  }
}

TEST(SolidAngle, DoesNotDependOnTheScenesOffset) {
  // Coordinates that move exactly: multiples of 2⁻³ by 2²⁰.
  const Vec3f offset(1 << 20, -(1 << 20), 1 << 19);
  const QuadShape q{{-1, -0.5f, 0.25f}, {2, 0, 0}, {0, 1, 0}};
  const TriangleShape t{{0, 0, 0}, {2, 0.125f, 0}, {0.5f, 1, -0.25f}};
  const LightShape quad = q, moved_quad = QuadShape{q.o + offset, q.u, q.v}, triangle = t,
                   moved_triangle = TriangleShape{t.p0 + offset, t.p1 + offset, t.p2 + offset};
  const Vec3d x(0.375, 0.25, 0.625);
  EXPECT_EQ(SeenShape(quad, x).solid_angle(), SeenShape(moved_quad, x + Vec3d(offset)).solid_angle());
  EXPECT_EQ(SeenShape(triangle, x).solid_angle(), SeenShape(moved_triangle, x + Vec3d(offset)).solid_angle());
  EXPECT_EQ(pdf_area(quad, x, {0, 0, 0.25}, {0, 0, 1}),
            pdf_area(moved_quad, x + Vec3d(offset), Vec3d(offset) + Vec3d(0, 0, 0.25), {0, 0, 1}));
}

/// Solid angle of the triangle of corner minus x and two edges.
long double omega_of(const Vec3d& corner, const Vec3d& u, const Vec3d& v) {
  using V = Imath::Vec3<long double>;
  const V a(corner), b = a + V(u), c = a + V(v);
  const long double la = std::sqrt(a.dot(a)), lb = std::sqrt(b.dot(b)), lc = std::sqrt(c.dot(c));
  return 2 * std::atan2(std::abs(a.dot(V(u).cross(V(v)))),
                        la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
}

TEST(SphericalTriangle, SamplesCutOffTheirShareOfTheSolidAngle) {
  // With a nearest to x and b next to it, the first number u is the share of (a, b, q) for a sample q on edge
  // a→c (second number 1). Slivers, needles and blades; near, far, grazing, almost on an edge.
  const Vec3d shapes[][2] = {{{2, 0, 0}, {0.5, 1, 0}},
                             {{2, 0, 0}, {1, 1e-5, 0}},
                             {{1e-5, 0, 0}, {1, 3, 0}},
                             {{2, 0, 0}, {-1, 1e-9, 0}},
                             {{1e6, 0, 0}, {0.5e6, 1, 0}}};
  const Vec3d corners[] = {
      {1, 2, -1}, {-0.8, -0.3, -1e-3}, {1e4, 2e4, -3e4}, {5, 0.3, -1e-4}, {1, 1e-6, -1e-6}};
  for (const auto& edges : shapes)
    for (const Vec3d& corner : corners) {
      const SphericalTriangle t(corner, edges[0], edges[1]);
      const long double whole = omega_of(corner, edges[0], edges[1]);
      EXPECT_NEAR(static_cast<double>(t.solid_angle() / whole), 1, 16 * 0x1p-53);
      const Vec3d vertex[3] = {corner, corner + edges[0], corner + edges[1]};
      int a = 0;
      for (const int k : {1, 2})
        if (vertex[k].length() < vertex[a].length()) a = k;
      const Vec3d next_edge[3] = {edges[0], edges[1] - edges[0], -edges[1]};
      const Vec3d to_b = next_edge[a], to_c = -next_edge[(a + 2) % 3];
      for (const double u : {1e-9, 0.1, 0.5, 0.9, 1 - 1e-9}) {
        const Vec2d w = t.sample({u, 1});
        const double weight[3] = {1 - w.x - w.y, w.x, w.y};
        const long double share = omega_of(vertex[a], to_b, weight[(a + 2) % 3] * to_c) / whole;
        EXPECT_NEAR(static_cast<double>(share), u, 5e-14) << t.solid_angle() << " sr";
      }
    }
}

TEST(SphericalTriangle, SamplesStayInsideAtTheEndsOfTheUnitSquare) {
  const double last = 1 - 0x1p-53;
  for (uint64_t i = 0; i < 200; ++i) {
    const LightShape t = TriangleShape{vector(4 * i), vector(4 * i + 1), vector(4 * i + 2)};
    const SeenShape seen(t, 2.0 * Vec3d(vector(4 * i + 3)));
    if (seen.solid_angle() == 0) continue;
    const auto& shape = std::get<TriangleShape>(t);
    const Vec3d u = Vec3d(shape.p1) - Vec3d(shape.p0), v = Vec3d(shape.p2) - Vec3d(shape.p0), n = u.cross(v);
    for (const double a : {0.0, 0x1p-53, 0.5, last})
      for (const double b : {0.0, 0x1p-53, 0.5, last}) {
        const LightPoint p = seen.sample({a, b});
        const Vec3d d = p.p - Vec3d(shape.p0);
        const double s = d.cross(v).dot(n) / n.length2(), w = u.cross(d).dot(n) / n.length2();
        const double slack = 1e-13 * u.length() * v.length() / n.length();
        EXPECT_TRUE(s >= -slack && w >= -slack && s + w <= 1 + slack) << i << ": " << a << ' ' << b;
        EXPECT_EQ(p.pdf, 1 / seen.solid_angle());
      }
  }
}

}  // namespace
}  // namespace penumbra
