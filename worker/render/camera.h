#pragma once
// pbrt's perspective camera: looks along +z of its left-handed space, fov across the shorter axis.
#include "absl/status/statusor.h"
#include "scenes/description.h"
#include "worker/geometry/geometry.h"

namespace penumbra {

/// A camera ray with the directions one pixel to the right and below, for texture footprints.
struct CameraRay {
  Vec3f origin, direction;           ///< direction unit
  Vec3f direction_dx, direction_dy;  ///< unit; origin shared (the pinhole, or a point of a lens)
  float time = 0;                    ///< of the shutter, in [0,1]
};

class Camera {
 public:
  /// For an image of width × height pixels. InvalidArgument for a field of view outside (0,180) or a
  /// singular placement. Other camera types are rendered as perspective, with a warning from unsupported().
  static absl::StatusOr<Camera> build(const SceneDescription& description, int width, int height);

  /// Ray through a point of the image, in pixels from the upper left corner.
  CameraRay ray(const Vec2d& pixel) const;

  /// The pinhole, and from there a point of what the ray sees; linear in the pixel. World space.
  const Vec3d& pinhole() const { return origin_; }
  Vec3d towards(const Vec2d& pixel) const { return corner_ + right_ * pixel.x + down_ * pixel.y; }

  /// Extent in camera space of a pixel at depth 1.
  Vec2d pixel_size() const { return pixel_size_; }

  /// Homogeneous image coordinates (w x, w y, w) of a point in world space: the pixel that sees it is (x, y)
  /// if w > 0; w is the depth along the viewing axis, in camera space.
  Vec3d project(const Vec3d& p) const { return (p - origin_) * to_image_; }

 private:
  Vec3f direction_at(const Vec2d& pixel) const;
  Vec3d origin_, corner_, right_, down_;  ///< world: direction = corner + x right + y down
  Vec2d pixel_size_;
  Imath::M33d to_image_;  ///< inverse of the rows right, down, corner
};

}  // namespace penumbra
