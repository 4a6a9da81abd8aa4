#pragma once
// Small convex polygons, relative to x, and their clipping by planes.
#include <array>
#include <initializer_list>
#include <span>

#include "proto/status.h"
#include "scenes/math.h"

namespace penumbra {

class ConvexPolygon {
 public:
  /// A quad cut by a horizon and by the four sides that a clipped triangle can have: a cut adds one corner.
  static constexpr int kMostCorners = 9;

  ConvexPolygon() { corners_.fill(Vec3d(0)); }
  ConvexPolygon(std::initializer_list<Vec3d> corners) : ConvexPolygon() {
    for (const Vec3d& c : corners) push_back(c);
  }
  void push_back(const Vec3d& corner) {
    PENUMBRA_CHECK(size_ < kMostCorners);
    corners_[size_++] = corner;
  }
  std::span<const Vec3d> corners() const { return {corners_.data(), static_cast<size_t>(size_)}; }
  bool empty() const { return size_ < 3; }

 private:
  std::array<Vec3d, kMostCorners> corners_;
  int size_ = 0;
};

/// The part where normal · p >= height.
ConvexPolygon clip(const ConvexPolygon& polygon, const Vec3d& normal, double height = 0);

}  // namespace penumbra
