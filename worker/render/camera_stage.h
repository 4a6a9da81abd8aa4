#pragma once
// Where an effect takes part in making camera rays. Chosen once at load (worker/effects/effects.h): a scene
// without such an effect has no stage, and pays one test of a null pointer per camera ray. This header is all
// that effects know of this room.
#include <vector>

#include "worker/render/camera.h"
#include "worker/sampling/sampler.h"

namespace penumbra {

/// A camera ray and the factor of the radiance that arrives along it.
struct WeightedRay {
  CameraRay ray;
  float weight = 1;
};

/// What a stage draws with: ray i of the n that a pass sends from a pixel.
struct CameraDraw {
  const PassSampler& sampler;
  int i = 0, n = 1;
};

class CameraStage {
 public:
  virtual ~CameraStage() = default;

  /// Replaces the pinhole's ray: `out` becomes rays whose weighted radiances sum to an estimate of what the
  /// camera measures at that point of the film, without bias. Weights are not negative; without rays it is 0.
  virtual void rays(const CameraRay& pinhole, const CameraDraw& draw,
                    std::vector<WeightedRay>& out) const = 0;

  /// A point at `depth` (along the viewing axis, in camera space, positive) is seen from up to this far from
  /// its projection, in pixels per (width, height) of a pixel at depth 1 of camera space.
  virtual double spread(double depth) const = 0;
};

}  // namespace penumbra
