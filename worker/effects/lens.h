#pragma once
// Depth of field of a thin lens (pbrt-v3 §6.2.3), by points of the lens and by chords of it (Tzeng, Patney,
// Davidson, Ebeida, Mitchell & Owens 2012). The lens is a disk about the pinhole, across the viewing axis, in
// camera space: the camera's transform scales it as it scales everything else.
#include "absl/status/statusor.h"
#include "worker/render/camera_stage.h"

namespace penumbra {

class Lens : public CameraStage {
 public:
  /// From the camera's `float lensradius` (> 0) and `float focaldistance` (default 1e6), camera space.
  /// InvalidArgument: a focal distance that is not positive and finite, a radius that is not finite.
  static absl::StatusOr<Lens> build(const SceneDescription& description);

  /// Points (mix lens=point): one ray of weight 1 from a uniform point of the disk through the point in
  /// focus. Lines (lens=line): see chord_rays.
  void rays(const CameraRay& pinhole, const CameraDraw& draw, std::vector<WeightedRay>& out) const override;

  /// A quarter as many chords as points: each costs as much as several rays, and has no noise along itself.
  int emission_samples(const Mix& mix, int rays) const override;

  double blur(double depth) const override;

 private:
  /// Where a ray of the pinhole is at depth 1 of camera space, relative to the lens' centre.
  Vec3d at_unit_depth(const Vec3f& direction) const;
  /// A point of the unit disk on the lens.
  Vec3d on_lens(const Vec2d& disk) const { return centre_ + right_ * disk.x + up_ * disk.y; }
  CameraRay ray(const CameraRay& pinhole, const Vec3d& from) const;
  void chord_rays(const CameraRay& pinhole, const CameraDraw& draw, std::vector<WeightedRay>& out) const;

  Vec3d centre_, right_, up_;               ///< world; right and up are radii of the disk
  Vec3d depth_;                             ///< (p - centre)·depth: along the axis, in camera space
  double radius_ = 0, focal_distance_ = 0;  ///< camera space
};

/// A chord of the unit disk.
struct DiskChord {
  Vec2d a, b;
};

/// Direction uniform by u.x, offset by u.y with density proportional to the chord's length, 2√(1−s²)/π: a
/// uniform point of the chord is then uniform on the disk, for every direction.
DiskChord disk_chord(const Vec2d& u);

}  // namespace penumbra
