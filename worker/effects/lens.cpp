#include "worker/effects/lens.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "proto/status.h"
#include "worker/sampling/warp.h"

namespace penumbra {
namespace {

Vec3d times(const Vec3d& v, const Matrix& m) {
  Vec3d out;
  m.multDirMatrix(v, out);
  return out;
}

Vec3f unit(const Vec3d& v) {
  return Vec3f(v.normalized());
}

}  // namespace

absl::StatusOr<Lens> Lens::build(const SceneDescription& description) {
  const Params& params = description.camera.params;
  const auto place = [&](const char* name) {
    const Param* given = params.find(name);
    return description.place(given ? given->loc : description.camera.loc);
  };
  Lens lens;
  lens.radius_ = params.number("lensradius", 0);
  lens.focal_distance_ = params.number("focaldistance", 1e6);
  if (!std::isfinite(lens.radius_))
    return invalid_input("{}: lensradius {} must be finite", place("lensradius"), lens.radius_);
  if (!(lens.focal_distance_ > 0) || !std::isfinite(lens.focal_distance_))
    return invalid_input("{}: focaldistance {} must be positive", place("focaldistance"),
                         lens.focal_distance_);

  const Matrix& to_camera = description.camera_placement.start;
  const Matrix to_world = to_camera.gjInverse();  // Camera::build() has refused a singular one
  to_world.multVecMatrix(Vec3d(0), lens.centre_);
  lens.right_ = times({lens.radius_, 0, 0}, to_world);
  lens.up_ = times({0, lens.radius_, 0}, to_world);
  lens.depth_ = {to_camera[0][2], to_camera[1][2], to_camera[2][2]};
  return lens;
}

Vec3d Lens::at_unit_depth(const Vec3f& direction) const {
  const Vec3d d(direction);
  return d / d.dot(depth_);
}

CameraRay Lens::ray(const CameraRay& pinhole, const Vec3d& from) const {
  CameraRay ray;
  ray.origin = Vec3f(from);
  // From the origin as it is rounded, so that the ray meets what is in focus, at F = centre + f d with d at
  // depth
  // 1. F itself may lie at 1e200: F − origin is scaled by min(f, 1)/f.
  const double scale = std::min(focal_distance_, 1.);
  const Vec3d lens = (Vec3d(ray.origin) - centre_) * (scale / focal_distance_);
  ray.direction = unit(at_unit_depth(pinhole.direction) * scale - lens);
  ray.direction_dx = unit(at_unit_depth(pinhole.direction_dx) * scale - lens);
  ray.direction_dy = unit(at_unit_depth(pinhole.direction_dy) * scale - lens);
  ray.time = pinhole.time;
  return ray;
}

void Lens::rays(const CameraRay& pinhole, const CameraDraw& draw, std::vector<WeightedRay>& out) const {
  out.clear();
  if (draw.mix.lens == LensSampling::kLine) return chord_rays(pinhole, draw, out);
  out.push_back({ray(pinhole, on_lens(square_to_disk_concentric(draw.sampler.lens(draw.i, draw.n))))});
}

int Lens::emission_samples(const Mix& mix, int rays) const {
  return mix.lens == LensSampling::kLine ? (rays + 3) / 4 : rays;
}

double Lens::blur(double depth) const {
  // A point P at depth z and a lens point ℓ: the ray through both meets the plane in focus, at depth f, at
  // ℓ + (P − ℓ) f/z, which the pinhole sees at depth 1 at P/z + ℓ (1/f − 1/z).
  return radius_ * std::abs(1 / focal_distance_ - 1 / depth);
}

}  // namespace penumbra
