#pragma once
// The closed set of light shapes. A new shape needs: a file of its own, its name in the variant, and
// these overloads. Every density of a point is per solid angle at x (sr⁻¹); x is in world space.
// Set-up is in double from float inputs, and subtracts x before anything else: scene offsets cancel.
#include <variant>

#include "scenes/math.h"
#include "worker/lights/spherical_rectangle.h"
#include "worker/lights/spherical_triangle.h"
#include "worker/lights/visible_sphere.h"

namespace penumbra {

/// Parallelogram o + s u + t v that emits towards u × v.
struct QuadShape {
  Vec3f o, u, v;
  /// u ⟂ v to rounding: then `sa` and `line-sa` use the spherical rectangle, else two triangles.
  bool rectangle() const;
};
/// Emits towards (p1-p0) × (p2-p0).
struct TriangleShape {
  Vec3f p0, p1, p2;
};
/// Emits outwards, or inwards.
struct SphereShape {
  Vec3f center;
  float radius = 1;
  bool inwards = false;
};
/// Annulus in the plane through center with unit normal n; emits towards n. A full disk: inner = 0.
struct DiskShape {
  Vec3f center, n;
  float radius = 1, inner = 0;
};
/// Open tube from base along axis (its length is the height); emits away from the axis, or inwards.
struct CylinderShape {
  Vec3f base, axis;
  float radius = 1;
  bool inwards = false;
};

using LightShape = std::variant<QuadShape, TriangleShape, SphereShape, DiskShape, CylinderShape>;

double area(const LightShape& shape);

/// A point of a light and how it was found.
struct LightPoint {
  Vec3d p{0, 0, 0};  ///< on the shape
  Vec3d n{0, 0, 0};  ///< unit, emission side
  double pdf = 0;    ///< sr⁻¹ at x; 0: not usable (edge on, or seen from behind)
};

/// `area`: p_A = 1/A. Points that face away from x get pdf 0.
LightPoint sample_area(const LightShape& shape, const Vec3d& x, const Vec2d& u);
/// Density of sample_area at direction x→p, p on the shape with unit normal n.
double pdf_area(const LightShape& shape, const Vec3d& x, const Vec3d& p, const Vec3d& n);

/// What `sa` and `line-sa` know of a shape from one x; made once per (x, light) and shared by all samples.
/// A shape seen from behind, edge-on or not at all has solid_angle 0. Keeps a pointer to the shape. Belongs
/// to one thread: what only some samples need is made at its first use.
class SeenShape {
 public:
  SeenShape(const LightShape& shape, const Vec3d& x);
  /// Solid angle of the shape's set-up (sr): rectangle UFK13, triangle (Arvo 1995, Van Oosterom &
  /// Strackee), sphere's cone, or 4π inside one. Disk and cylinder have no parametrisation and 0: use area
  /// (has_solid_angle false).
  double solid_angle() const { return solid_angle_; }
  bool has_solid_angle() const;

  /// `sa`. Falls back to area sampling where has_solid_angle() is false.
  LightPoint sample(const Vec2d& u) const;
  /// Density of sample() at p on the shape; 0 where sample() cannot reach.
  double pdf(const Vec3d& p, const Vec3d& n) const;

  const LightShape& shape() const { return *shape_; }
  const Vec3d& x() const { return x_; }
  /// The rectangle's frame at x; null for every other shape.
  const SphericalRectangle* rectangle() const { return std::get_if<SphericalRectangle>(&frame_); }

 private:
  /// No set-up: disks and cylinders.
  struct AreaOnly {};
  /// A parallelogram without right angles: o, o+u, o+u+v and o, o+u+v, o+v.
  struct TwoTriangles {
    SphericalTriangle first, second;
  };
  using Frame = std::variant<AreaOnly, SphericalRectangle, SphericalTriangle, TwoTriangles, VisibleSphere>;
  static Frame make_frame(const LightShape& shape, const Vec3d& x);

  const LightShape* shape_;
  Vec3d x_;
  Frame frame_;
  double solid_angle_;
};

}  // namespace penumbra
