#include "worker/lights/shape.h"

#include <cmath>

#include "worker/lights/cylinder.h"
#include "worker/lights/disk.h"
#include "worker/lights/quad.h"
#include "worker/lights/sphere.h"
#include "worker/lights/triangle.h"

namespace penumbra {

double area(const LightShape& shape) {
  return std::visit([](const auto& s) { return area(s); }, shape);
}

LightPoint sample_area(const LightShape& shape, const Vec3d& x, const Vec2d& u) {
  LightPoint point = std::visit([&](const auto& s) { return point_on(s, u); }, shape);
  point.pdf = pdf_area(shape, x, point.p, point.n);
  return point;
}

double pdf_area(const LightShape& shape, const Vec3d& x, const Vec3d& p, const Vec3d& n) {
  // p_ω = p_A r²/cosθ_l with cosθ_l = (distance of x in front of the tangent plane at p)/r.
  const double height = std::visit([&](const auto& s) { return height_above(s, x, p, n); }, shape);
  if (!(height > 0)) return 0;
  const double r2 = (p - x).length2();
  return r2 * std::sqrt(r2) / (height * area(shape));
}

SeenShape::Frame SeenShape::make_frame(const LightShape& shape, const Vec3d& x) {
  struct Maker {
    const Vec3d& x;
    Frame operator()(const QuadShape& q) const {
      const Vec3d o = Vec3d(q.o) - x, u(q.u), v(q.v);
      if (q.rectangle()) return SphericalRectangle(o, u, v);
      return TwoTriangles{{o, u, u + v}, {o, u + v, v}};
    }
    Frame operator()(const TriangleShape& t) const {
      const Vec3d corner(t.p0);
      return SphericalTriangle(corner - x, Vec3d(t.p1) - corner, Vec3d(t.p2) - corner);
    }
    Frame operator()(const SphereShape& s) const {
      return VisibleSphere(Vec3d(s.center) - x, s.radius, s.inwards);
    }
    Frame operator()(const DiskShape&) const { return AreaOnly{}; }
    Frame operator()(const CylinderShape&) const { return AreaOnly{}; }
  };
  return std::visit(Maker{x}, shape);
}

namespace {

// Overloads for std::visit.
template <class... F>
struct Cases : F... {
  using F::operator()...;
};

}  // namespace

SeenShape::SeenShape(const LightShape& shape, const Vec3d& x)
    : shape_(&shape), x_(x), frame_(make_frame(shape, x)) {
  solid_angle_ =
      std::visit(Cases{[](const AreaOnly&) { return 0.0; },
                       [](const TwoTriangles& t) { return t.first.solid_angle() + t.second.solid_angle(); },
                       [](const auto& frame) { return frame.solid_angle(); }},
                 frame_);
}

bool SeenShape::has_solid_angle() const {
  return !std::holds_alternative<AreaOnly>(frame_);
}

LightPoint SeenShape::sample(const Vec2d& u) const {
  if (!has_solid_angle()) return sample_area(*shape_, x_, u);
  if (solid_angle_ == 0) return {};
  const auto of_rectangle = [&](const SphericalRectangle& r) {
    return LightPoint{position_at(std::get<QuadShape>(*shape_), r.sample(u)), r.normal()};
  };
  const auto of_triangle = [&](const SphericalTriangle& t) {
    return LightPoint{position_at(std::get<TriangleShape>(*shape_), t.sample(u)), t.normal()};
  };
  const auto of_parallelogram = [&](const TwoTriangles& t) {
    // A triangle by its solid angle, and what is left of the random number within it.
    const double share = t.first.solid_angle() / solid_angle_;
    const bool in_first = u.x < share;
    const Vec2d rest(in_first ? u.x / share : (u.x - share) / (1 - share), u.y);
    const Vec2d b = in_first ? t.first.sample(rest) : t.second.sample(rest);
    // Of o, o+u, o+u+v the weights (b, c) are at u (b+c), v c; of o, o+u+v, o+v at u b, v (b+c).
    const Vec2d fractions = in_first ? Vec2d(b.x + b.y, b.y) : Vec2d(b.x, b.x + b.y);
    return LightPoint{position_at(std::get<QuadShape>(*shape_), fractions), t.first.normal()};
  };
  const auto of_sphere = [&](const VisibleSphere& s) {
    return point_at(std::get<SphereShape>(*shape_), s.sample_normal(u));
  };
  LightPoint point = std::visit(Cases{[](const AreaOnly&) { return LightPoint(); }, of_rectangle, of_triangle,
                                      of_parallelogram, of_sphere},
                                frame_);
  point.pdf = 1 / solid_angle_;
  return point;
}

double SeenShape::pdf(const Vec3d& p, const Vec3d& n) const {
  if (!has_solid_angle()) return pdf_area(*shape_, x_, p, n);
  if (solid_angle_ == 0) return 0;
  // All of a flat shape is seen at once; of a sphere only the side that faces x.
  if (std::holds_alternative<VisibleSphere>(frame_) && !((x_ - p).dot(n) > 0)) return 0;
  return 1 / solid_angle_;
}

}  // namespace penumbra
