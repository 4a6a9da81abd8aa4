#pragma once
// Radiance along one camera ray: emission, direct light, and chains of specular bounces.
#include "worker/render/camera.h"
#include "worker/render/scene.h"
#include "worker/strategies/direct_light.h"

namespace penumbra {

class PathTracer {
 public:
  /// `max_depth`: vertices that get direct light; 1 follows no specular bounce.
  PathTracer(const Scene& scene, const PreparedMix& mix, int max_depth, QueryCounters& counters)
      : scene_(scene),
        direct_({*scene.geometry, scene.lights}, mix, counters),
        max_depth_(max_depth),
        counters_(counters) {}

  /// Everything that arrives along the ray; without `emission`, all but what an area light's surface that the
  /// ray meets first emits by itself.
  Rgb radiance(const CameraRay& ray, const PassSampler& sampler, bool emission = true);
  /// What radiance() leaves out then.
  Rgb emission(const CameraRay& ray);

 private:
  Rgb emitted(const Hit& hit, const Ray& ray);
  Rgb background(const Vec3f& direction) const;
  /// One specular lobe, drawn in proportion to its throughput; false where there is none.
  bool bounce(const ShadingPoint& point, const PassSampler& sampler, int depth, Vec3f& direction, Rgb& throughput) const;

  const Scene& scene_;
  DirectLight direct_;
  int max_depth_;
  QueryCounters& counters_;
};

}  // namespace penumbra
