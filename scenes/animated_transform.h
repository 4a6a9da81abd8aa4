#pragma once
// pbrt's interpolation between two placements (pbrt-v3 §2.9): translation and stretch linearly, rotation
// along the shortest arc of unit quaternions.
#include <ImathQuat.h>

#include <cstdint>
#include <optional>
#include <vector>

#include "scenes/description.h"

namespace penumbra {

/// When the camera's shutter is open, in units of TransformTimes: 0 is the time of the first transform, 1
/// that of the second; pbrt holds the nearer one outside.
struct Shutter {
  double open = 0, close = 1;
};
/// From the camera's `float shutteropen`, `shutterclose` (defaults 0 and 1) and TransformTimes.
Shutter shutter_of(const SceneDescription& description);

/// An axis-parallel box in double precision.
struct MovedBox {
  Vec3d lo, hi;
};

/// A placement that changes while the shutter is open. Times u run from 0, when it opens, to 1, when it
/// closes.
class AnimatedTransform {
 public:
  /// From start to end, both affine and not singular. Empty where one of them mirrors and the other does not:
  /// what lies between would be flat at some time.
  static std::optional<AnimatedTransform> between(const Matrix& start, const Matrix& end,
                                                  const Shutter& shutter);

  /// Object to world at a time u in [0,1].
  Matrix at(double u) const;

  /// Where a box of object space is: in n + 1 world boxes at the times 0, 1/n, …, 1. At any other time the
  /// object lies within the linear interpolation of the two next to it. n is chosen so that they are close.
  std::vector<MovedBox> boxes(const MovedBox& object) const;

  /// How much it turns and stretches while the shutter is open: radians, plus the share by which lengths
  /// change. 0: every point goes straight and evenly, but for the ends.
  double turn() const;
  /// Appends the times within (0,1) at which the motion begins or ends.
  void add_ends(std::vector<double>& times) const;

  /// Of this motion, in this process.
  uint64_t id() const { return id_; }

 private:
  AnimatedTransform() = default;
  /// The transforms' own time, in [0,1].
  double clamped(double u) const;
  /// Distance of a moved point of the box from a linear motion between two times 1/n apart, at most.
  double deviation(const MovedBox& object, int n) const;

  uint64_t id_ = 0;
  Shutter shutter_;
  Matrix start_, end_;
  // start = stretch · rotation · translation, as row vectors have it.
  Imath::M33d stretch_[2];
  Imath::Quatd rotation_[2];
  Vec3d translation_[2];
  double angle_ = 0;          ///< between the rotations, as points turn, radians
  bool same_linear_ = false;  ///< nothing but the translation changes
};

}  // namespace penumbra
