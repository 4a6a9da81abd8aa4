#pragma once
// The end of a shadow segment on a flat light: what a ray meets close to the light is judged in double
// precision, because a ray's own distances do not tell a cover in front of a light from one behind it.
#include <algorithm>
#include <cmath>

#include "worker/geometry/geometry.h"

namespace penumbra {

/// One segment from x to a point of a flat light, refers to its arguments.
class LightApproach {
 public:
  // Here, and in single precision, because every shadow ray makes one: more or less doubt by a rounding
  // changes nothing. Derived in light_end.cpp.
  LightApproach(const Vec3f& x, const LightEnd& end)
      : x_(x), end_(end), way_(end.p - Vec3d(x)), height_(std::abs(Vec3f(end.plane.normal).dot(way_))) {
    lengths_ = norm1(Vec3f(end.p)) + norm1(way_);
  }

  /// From x to the end, for the ray.
  const Vec3f& way() const { return way_; }

  /// Nothing but the light itself can be met where there is doubt.
  bool alone() const {
    return !end_.crowded && kRounding * lengths_ <= kLeastDoubt * height_ && norm1(way_) <= kSteepest * height_;
  }
  /// Then, where a ray ends before the light, in lengths of the way.
  float before() const { return 1 - kRounding * lengths_ / height_; }

  /// A surface that a ray meets at less than kJudged of the way hides the light; at more than beyond() it
  /// does not. Between, hides() decides. `extent`: sum of the extents of all surfaces.
  static constexpr float kJudged = 0.5f;
  float beyond(float extent) const { return 1 + doubt(lengths_ + extent, height_); }

  /// How far a ray's distance to a plane may be off, as a share of it. `lengths`: sum of all lengths in it.
  static float doubt(float lengths, float height) {
    const float rounding = kRounding * lengths;
    return rounding < kMostDoubt * height ? std::max(kLeastDoubt, rounding / height) : kMostDoubt;
  }

  /// Does the surface hide the end, given that a ray met it on its way? `surface`: the triangle met.
  bool hides(const Vec3d surface[3]) const;

  /// What is farther than this from a light with coordinates up to `largest` is never in doubt for rays of
  /// extents up to `reach`, where a ray is alone: it ends kRounding · lengths / height of its way before the
  /// light, which is kSteepest times kRounding · lengths at most, in whatever direction it comes.
  static double closest(const Vec3d& largest, const Vec3d& reach) {
    // Twice: the rounding of that distance.
    return 2 * double{kSteepest} * double{kRounding} * (norm1(largest) + norm1(reach));
  }

 private:
  static constexpr float kRounding = 0x1p-19f, kLeastDoubt = 0x1p-11f, kMostDoubt = 0.5f;
  /// Way over height of rays that may be alone: those that graze the light would need more room than lights
  /// mostly have.
  static constexpr float kSteepest = 8;
  template <class T>
  static T norm1(const Imath::Vec3<T>& v) {
    return std::abs(v.x) + std::abs(v.y) + std::abs(v.z);
  }

  const Vec3f& x_;
  const LightEnd& end_;
  Vec3f way_;
  float height_, lengths_;
};

}  // namespace penumbra
