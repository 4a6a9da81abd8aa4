#pragma once
// What of a flat light can be seen from x, exactly: the light's polygon less the shadows that a few triangles
// throw on it from x, as convex pieces. The two-dimensional sister of a chord's visible intervals. Everything
// happens in the light's own coordinates, p = o + s u + t v: a plane through x is a straight line there.
#include <array>
#include <span>
#include <vector>

#include "worker/lights/shape.h"

namespace penumbra {

/// Keeps its memory from one light to the next; belongs to one thread.
class VisibleRegion {
 public:
  /// Beyond so many pieces a region is not worth its making.
  static constexpr int kMostPieces = 48;

  /// Nothing.
  void clear();
  /// All of a quad or triangle that x sees if nothing hides it: from the front, and above the horizon through
  /// x with the unit normal `horizon` (0: no horizon). `rounding`: by which the light's points may be off its
  /// plane; occluders hide from their own rounding before that on.
  void reset(const LightShape& shape, const Vec3d& x, const Vec3d& horizon, double rounding = 0);
  /// Takes away what the triangle hides: it may lie anywhere, behind x and beyond the light it hides nothing.
  /// False: that would be too many pieces; the region is of no use then.
  bool subtract(const std::array<Vec3f, 3>& triangle);
  /// Makes sample() ready.
  void finish();

  /// All of the light is visible, and sampling it whole is sampling this.
  bool whole() const { return whole_; }
  bool empty() const { return pieces_.empty(); }
  size_t pieces() const { return pieces_.size(); }
  /// Part of the light's area; in [0,1] to rounding.
  double area_fraction() const;
  /// sr; after finish().
  double solid_angle() const { return patches_.empty() ? 0 : patches_.back().up_to; }

  /// A point uniform in the region's solid angle; pdf 0 if there is none. After finish().
  LightPoint sample(const Vec2d& u) const;
  /// Density of sample() at a point of the light, sr⁻¹; 0 outside the region.
  double pdf(const Vec3d& p) const;
  /// Is the point of the light in the region?
  bool holds(const Vec3d& p) const;

 private:
  /// In the light's coordinates, counterclockwise.
  struct Polygon {
    static constexpr int kMostCorners = 12;
    std::array<Vec2d, kMostCorners> corners;
    int size = 0;
    Polygon() { corners.fill(Vec2d(0)); }
    std::span<const Vec2d> all() const { return {corners.data(), size_t(size)}; }
    double area() const;
    /// Puts a corner at the end; false: there is no room.
    bool add(const Vec2d& corner);
  };
  /// What a plane through x cuts the light into: inside where n · (1, s, t) >= 0. Smaller values than
  /// `rounding` say nothing.
  struct Side {
    Vec3d n{0, 0, 0};
    double rounding = 0;
    /// n · (1, s, t), or 0.
    double at(const Vec2d& corner) const;
  };
  /// A triangle of a piece.
  struct Patch {
    SphericalTriangle seen;
    Vec3d corner, u, v;  ///< the corner minus x
    double up_to = 0;    ///< the solid angle of this and those before it
  };

  Side side_of(const Vec3d& n, double rounding) const;
  /// Of the plane through x and an edge, turned by the sign of `turn`.
  Side side_along(const Vec3d& from, const Vec3d& to, double turn) const;
  bool subtract(const Polygon& piece, std::span<const Side> shadow);
  /// False: too many corners.
  static bool split(const Polygon& piece, const Side& side, Polygon& inside, Polygon& outside);
  bool keep(const Polygon& piece);

  Vec3d x_{0, 0, 0};
  Vec3d o_{0, 0, 0}, u_{0, 0, 0}, v_{0, 0, 0};  ///< of the light, o minus x
  Vec3d across_{0, 0, 0};                       ///< u × v: the emission side
  double depth_ = 0;                            ///< of the light's plane along −across, × |across|: > 0
  double rounding_ = 0;                         ///< of the light's points along across, × |across|
  double full_area_ = 1;                        ///< of the light, in its coordinates
  bool whole_ = false;
  std::vector<Polygon> pieces_, before_;
  std::vector<Patch> patches_;
};

}  // namespace penumbra
