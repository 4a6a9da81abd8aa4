#include "worker/render/camera.h"

#include <cmath>
#include <numbers>

#include "proto/status.h"

namespace penumbra {

absl::StatusOr<Camera> Camera::build(const SceneDescription& description, int width, int height) {
  const Entity& e = description.camera;
  const std::string at = description.place(e.loc);
  double fov = e.params.number("fov", 90);
  if (const Param* half = e.params.find("halffov"); half && !half->numbers.empty())
    fov = 2 * half->numbers[0];
  if (!(fov > 0 && fov < 180)) return invalid_input("{}: fov {} must lie between 0 and 180 degrees", at, fov);

  // pbrt's screen window: [-1,1] across the shorter axis, wider along the other (pbrt-v3 §6.2).
  const double aspect = e.params.number("frameaspectratio", double(width) / height);
  double x0 = -1, x1 = 1, y0 = -1, y1 = 1;
  if (aspect > 1) {
    x0 = -aspect;
    x1 = aspect;
  } else {
    y0 = -1 / aspect;
    y1 = 1 / aspect;
  }
  if (const Param* window = e.params.find("screenwindow")) {
    if (window->numbers.size() != 4) return invalid_input("{}: screenwindow needs 4 numbers", at);
    x0 = window->numbers[0];
    x1 = window->numbers[1];
    y0 = window->numbers[2];
    y1 = window->numbers[3];
  }
  const double scale = std::tan(fov * std::numbers::pi / 360);

  const Matrix& world_to_camera = description.camera_placement.start;
  if (world_to_camera.determinant() == 0) return invalid_input("{}: the camera's transform is singular", at);
  const Matrix to_world = world_to_camera.gjInverse();
  const auto direction = [&](const Vec3d& d) {
    Vec3d out;
    to_world.multDirMatrix(d, out);
    return out;
  };
  Camera camera;
  to_world.multVecMatrix(Vec3d(0), camera.origin_);
  camera.corner_ = direction({x0 * scale, y1 * scale, 1});
  camera.right_ = direction({(x1 - x0) * scale / width, 0, 0});
  camera.down_ = direction({0, (y0 - y1) * scale / height, 0});
  camera.pixel_size_ = {std::abs(x1 - x0) * scale / width, std::abs(y1 - y0) * scale / height};
  Imath::M33d from_image;
  for (int k = 0; k < 3; ++k) {
    from_image[0][k] = camera.right_[k];
    from_image[1][k] = camera.down_[k];
    from_image[2][k] = camera.corner_[k];
  }
  camera.to_image_ = from_image.gjInverse();
  return camera;
}

Vec3f Camera::direction_at(const Vec2d& pixel) const {
  return Vec3f(towards(pixel).normalized());
}

CameraRay Camera::ray(const Vec2d& pixel) const {
  return {Vec3f(origin_), direction_at(pixel), direction_at(pixel + Vec2d(1, 0)),
          direction_at(pixel + Vec2d(0, 1)), 0};
}

}  // namespace penumbra
