#include "worker/effects/motion.h"

#include "proto/status.h"
#include "worker/effects/looks.h"

namespace penumbra {
namespace {

Vec3f carried_direction(const Vec3f& d, const Matrix& m) {
  Vec3d out;
  m.multDirMatrix(Vec3d(d), out);
  return Vec3f(out.normalized());
}

void carry(CameraRay& ray, const Matrix& m) {
  Vec3d origin;
  m.multVecMatrix(Vec3d(ray.origin), origin);
  ray.origin = Vec3f(origin);
  for (Vec3f* d : {&ray.direction, &ray.direction_dx, &ray.direction_dy}) *d = carried_direction(*d, m);
}

}  // namespace

absl::StatusOr<Motion> Motion::build(const SceneDescription& description,
                                     std::shared_ptr<const CameraStage> lens) {
  Motion motion;
  motion.lens_ = std::move(lens);
  const Placement& camera = description.camera_placement;
  if (!camera.moving()) return motion;
  // pbrt interpolates from camera to world.
  const auto animated =
      AnimatedTransform::between(camera.start.inverse(), camera.end.inverse(), shutter_of(description));
  if (!animated)
    return invalid_input("{}: the camera moves from a placement that mirrors to one that does not",
                         description.place(description.camera.loc));
  motion.camera_ = std::make_shared<const AnimatedTransform>(*animated);
  motion.to_camera_ = animated->at(0).inverse();
  return motion;
}

const Matrix* Motion::carried(float time, Matrix& storage) const {
  if (!camera_) return nullptr;
  storage = to_camera_ * camera_->at(double{time});
  return &storage;
}

void Motion::rays(const CameraRay& pinhole, const CameraDraw& draw, std::vector<WeightedRay>& out) const {
  const bool chords = lens_ && draw.mix.lens == LensSampling::kLine;
  if (draw.mix.motion == MotionSampling::kLine && !chords) return line_rays(pinhole, draw, out);
  CameraRay ray = pinhole;
  ray.time = static_cast<float>(draw.sampler.time(draw.i, draw.n));
  Matrix storage;
  const Matrix* const to_now = carried(ray.time, storage);
  if (lens_) {
    CameraDraw then = draw;
    then.camera_moved = to_now;
    lens_->rays(ray, then, out);
  } else {
    out.assign(1, {ray});
  }
  if (to_now == nullptr) return;
  for (WeightedRay& seen : out) carry(seen.ray, *to_now);
}

void Motion::line_rays(const CameraRay& pinhole, const CameraDraw& draw,
                       std::vector<WeightedRay>& out) const {
  thread_local std::vector<SeenInterval> seen;
  thread_local std::vector<Look> looks;
  // A point of the lens, at which the camera's motion takes the ray.
  if (lens_)
    lens_->rays(pinhole, draw, out);
  else
    out.assign(1, {pinhole});
  const WeightedRay at_opening = out.front();
  const CameraRay& ray = at_opening.ray;
  draw.geometry.nearest(RayInTime{Vec3d(ray.origin), Vec3d(ray.direction), camera_.get(), to_camera_}, seen,
                        draw.counters);
  looks_along(seen, draw.sampler.time(draw.i, draw.n), looks);
  out.clear();
  for (const Look& look : looks) {
    WeightedRay& then = out.emplace_back(at_opening);
    then.ray.time = static_cast<float>(look.at);
    then.weight *= static_cast<float>(look.weight);
    Matrix storage;
    if (const Matrix* const to_now = carried(then.ray.time, storage)) carry(then.ray, *to_now);
  }
}

int Motion::emission_samples(const Mix& mix, int rays) const {
  if (lens_ && mix.lens == LensSampling::kLine) return lens_->emission_samples(mix, rays);
  return mix.motion == MotionSampling::kLine ? (rays + 3) / 4 : rays;
}

double Motion::blur(double depth) const {
  return lens_ ? lens_->blur(depth) : 0;
}

}  // namespace penumbra
