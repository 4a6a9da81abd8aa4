#pragma once
// Where an effect takes part in making camera rays. Chosen once at load (worker/effects/effects.h): a scene
// without such an effect has no stage, and pays one test of a null pointer per camera ray. This header is all
// that effects know of this room.
#include <vector>

#include "proto/mix.h"
#include "worker/render/camera.h"
#include "worker/sampling/sampler.h"

namespace penumbra {

/// A camera ray and the factor of the radiance that arrives along it.
struct WeightedRay {
  CameraRay ray;
  float weight = 1;
};

/// What a stage draws with: sample i of the n that a pass takes of a pixel's film.
struct CameraDraw {
  const PassSampler& sampler;
  const Mix& mix;  ///< which may ask for lines
  const Geometry& geometry;
  QueryCounters& counters;
  int i = 0, n = 1;
  /// What has carried the camera along with its rays at the pinhole ray's time, row vectors; null: nothing.
  /// The stage makes rays for where it was.
  const Matrix* camera_moved = nullptr;
};

class CameraStage {
 public:
  virtual ~CameraStage() = default;

  /// Replaces the pinhole's ray: `out` becomes rays whose weighted radiances sum to an estimate of what the
  /// camera measures at that point of the film, without bias. Weights are not negative; without rays it is 0.
  virtual void rays(const CameraRay& pinhole, const CameraDraw& draw,
                    std::vector<WeightedRay>& out) const = 0;

  /// How many film samples a pass takes for the emission of a pixel that sees a light, where `rays` of a
  /// pinhole would do; a sample that integrates over part of what blurs the light needs fewer.
  virtual int emission_samples(const Mix&, int rays) const { return rays; }

  /// A point at `depth` (> 0, along the viewing axis in camera space) is seen at most this far from its
  /// projection, both at depth 1 of camera space.
  virtual double blur(double depth) const = 0;
};

}  // namespace penumbra
