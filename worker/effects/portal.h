#pragma once
// A rectangle that light from infinitely far away comes through, and no other of it (pbrt-v4, `"point3
// portal"`; Bitterli, Novák & Jarosz 2015). What is behind the rectangle as seen from x is a light with the
// rectangle's solid angle.
#include <memory>

#include "absl/status/statusor.h"
#include "scenes/description.h"
#include "worker/lights/line.h"
#include "worker/lights/shape.h"
#include "worker/lights/window_table.h"

namespace penumbra {

class Portal {
 public:
  /// Four corners in world space, in order. Light comes through towards (p1 − p0) × (p3 − p0).
  /// InvalidArgument: not four finite points, or not a rectangle by pbrt's measure (cosines within 1e-3).
  static absl::StatusOr<std::shared_ptr<Portal>> build(const Param& param, const SceneDescription& description);

  /// As a light that shines into the room: a QuadShape.
  const LightShape& shape() const { return shape_; }
  /// Does what comes from a direction w (unit) pass the rectangle on its way to x?
  bool passes(const Vec3d& x, const Vec3d& w) const;
  /// Axes along the edges and towards the sky, as rows, unit.
  const Imath::M33d& axes() const { return axes_; }
  /// What is behind it, to be drawn from; null: all alike.
  void set_table(WindowTable table) { table_ = std::make_shared<const WindowTable>(std::move(table)); }
  const WindowTable* table() const { return table_.get(); }

 private:
  LightShape shape_ = QuadShape{Vec3f(0), Vec3f(0), Vec3f(0)};
  Vec3d corner_, size_;  ///< size_: lengths of the edges
  Imath::M33d axes_;
  std::shared_ptr<const WindowTable> table_;
};

/// A portal as it is seen from x; made once per (x, light). Keeps a pointer to the portal. Belongs to one
/// thread. From behind, and from the portal's plane, nothing is seen: no samples, no lines.
class SeenPortal {
 public:
  SeenPortal(const Portal& portal, const Vec3d& x);

  /// Unit direction, and its density (sr⁻¹): by the table of what is behind it, uniform without one. 0: none.
  struct Sample {
    Vec3d w{0, 0, 0};
    double pdf = 0;
  };
  Sample sample(const Vec2d& u) const;
  double pdf(const Vec3d& w) const;

  /// Chords of the rectangle parallel to its edge u or v, uniform in solid angle, moved away from x along
  /// their rays to the plane at distance `far`. On that plane, p: a point of it.
  LightLine choose_chord(bool along_u, double u, double far) const;
  LightLine chord_through(bool along_u, const Vec3d& p, double far) const;
  /// How far along a unit direction through the rectangle that plane is.
  double distance_to(const Vec3d& w, double far) const;
  double solid_angle() const { return seen_.solid_angle(); }

 private:
  LightLine moved(LightLine line, double far) const;

  const Portal* portal_;
  SeenShape seen_;
  Vec3d lo_, hi_;  ///< the rectangle from x, in the portal's axes; hi_.z: distance of x from its plane
  WindowTable::Window window_;
  double integral_ = 0;  ///< of the table's values over the window
};

}  // namespace penumbra
