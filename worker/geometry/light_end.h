#pragma once
// The end of a shadow segment on a flat light: what a ray meets close to the light is judged in double
// precision, because a ray's own distances do not tell a cover in front of a light from one behind it.
#include <Imath/ImathBox.h>

#include <cmath>

#include "worker/geometry/geometry.h"

namespace penumbra {

/// One segment from x to a point of a flat light, refers to its arguments.
class LightApproach {
 public:
  /// What is farther than this share of the way from the light is never in doubt, at the least doubt: twice
  /// that, so that no rounding of a ray's distance takes it there.
  static constexpr float kLeastDoubt = 0x1p-11f, kClose = 2 * kLeastDoubt;

  // Here, and in single precision, because every shadow ray makes one: more or less doubt by a rounding
  // changes nothing. Derived in light_end.cpp.
  LightApproach(const Vec3f& x, const LightEnd& end) : x_(x), end_(end), way_(end.p - Vec3d(x)) {
    constexpr float kRounding = 0x1p-19f, kMostDoubt = 0.5f;
    const Vec3f p(end.p);
    const float largest = (std::abs(p.x) + std::abs(p.y) + std::abs(p.z)) +
                          (std::abs(way_.x) + std::abs(way_.y) + std::abs(way_.z));
    const float height = std::abs(Vec3f(end.n).dot(way_)), rounding = kRounding * largest;
    if (rounding <= height * kLeastDoubt)
      doubt_ = kLeastDoubt;
    else
      doubt_ = rounding < height * kMostDoubt ? rounding / height : kMostDoubt;
  }

  /// Nothing but the light itself can be met where there is doubt.
  bool alone() const { return !end_.crowded && doubt_ == kLeastDoubt; }

  /// From x to the end, for the ray.
  const Vec3f& way() const { return way_; }

  /// A surface that a ray meets at less than 1 - doubt() of the way hides the light; at more than 1 + doubt()
  /// it does not. Between, hides() decides.
  float doubt() const { return doubt_; }

  /// Does the surface hide the end, given that a ray met it on its way? `surface`: the triangle met; `light`:
  /// bounds of the light's vertices.
  bool hides(const Vec3d surface[3], const Imath::Box3f& light) const;

 private:
  const Vec3f& x_;
  const LightEnd& end_;
  Vec3f way_;
  float doubt_;
};

}  // namespace penumbra
