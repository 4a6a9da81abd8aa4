#pragma once
// Motion blur: every camera sample has a time, at which everything it meets stands still. A camera that moves
// carries its rays along.
#include <memory>

#include "absl/status/statusor.h"
#include "scenes/animated_transform.h"
#include "worker/render/camera_stage.h"

namespace penumbra {

class Motion : public CameraStage {
 public:
  /// `lens`: what else takes part in making camera rays, made for the camera as it stands when the shutter
  /// opens; may be null. InvalidArgument: a camera that moves from a placement that mirrors to one that does
  /// not.
  static absl::StatusOr<Motion> build(const SceneDescription& description,
                                      std::shared_ptr<const CameraStage> lens);

  /// Points (mix motion=point): the lens' rays, or the pinhole's, at a time uniform while the shutter is
  /// open, of the same weights. Lines (motion=line, unless the lens has lines of its own): see line_rays.
  void rays(const CameraRay& pinhole, const CameraDraw& draw, std::vector<WeightedRay>& out) const override;

  /// As with chords of a lens, a quarter as many lines as points.
  int emission_samples(const Mix& mix, int rays) const override;

  /// That of the lens: what moves is sharp at its time.
  double blur(double depth) const override;

 private:
  /// From where the camera's rays are when the shutter opens to where they are at a time; null: it stands.
  const Matrix* carried(float time, Matrix& storage) const;
  /// What the film's point sees is known from when to when: rays at a time of each stretch, weighted by its
  /// length.
  void line_rays(const CameraRay& pinhole, const CameraDraw& draw, std::vector<WeightedRay>& out) const;

  std::shared_ptr<const CameraStage> lens_;
  std::shared_ptr<const AnimatedTransform> camera_;  ///< to the world; null: it stands
  Matrix to_camera_;                                 ///< when the shutter opens
};

}  // namespace penumbra
