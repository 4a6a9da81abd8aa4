#pragma once
// Radiance along one camera ray: emission, direct light, and chains of specular bounces.
#include "worker/render/camera.h"
#include "worker/render/medium_lines.h"
#include "worker/render/scene.h"
#include "worker/strategies/direct_light.h"

namespace penumbra {

class PathTracer {
 public:
  /// `max_depth`: vertices that get direct light; 1 follows no specular bounce.
  /// `arrivals`: is told when everything arrives that radiance() and emission() return; null: nobody asks.
  PathTracer(const Scene& scene, const PreparedMix& mix, int max_depth, QueryCounters& counters,
             Arrivals* arrivals = nullptr)
      : scene_(scene),
        arrivals_(arrivals),
        walk_(scene.effects.media ? scene.effects.media->walk() : nullptr),
        direct_({*scene.geometry, scene.lights, walk_.get(), arrivals}, mix, counters),
        max_depth_(max_depth),
        counters_(counters) {
    if (walk_ && mix.lines_in_media()) lines_.emplace(scene, mix, walk_.get(), counters, arrivals);
  }

  /// Everything that arrives along the ray; without `emission`, all but what an area light's surface that the
  /// ray meets first emits by itself.
  Rgb radiance(const CameraRay& ray, const PassSampler& sampler, bool emission = true);
  /// What radiance() leaves out then.
  Rgb emission(const CameraRay& ray);
  /// Vertices so far, in media as well, that scatter light into narrow lobes.
  uint64_t narrow_vertices() const { return narrow_vertices_; }

 private:
  Rgb emitted(const Hit& hit, const Ray& ray);
  /// The same, told to arrivals as well, where the path stands.
  Rgb arrived(const Hit& hit, const Ray& ray);
  /// What media scatter towards the ray's origin from before `distance`; takes from the throughput what does
  /// not pass them.
  Rgb scattered(const Ray& ray, double distance, const PassSampler& sampler, int depth, Rgb& throughput);
  /// The same without the throughput, by points or by lines; `left`: the share of light that passes.
  Rgb scattered_by_points(const Ray& ray, double distance, const PassSampler& sampler, int depth, Rgb& left);
  Rgb scattered_by_lines(const Ray& ray, double distance, const PassSampler& sampler, int depth, Rgb& left);
  Rgb lit(const std::vector<ScatterVertex>& vertices, const Ray& ray, int depth, DirectLight& direct);
  Rgb background(const Ray& ray) const;
  /// One specular lobe, drawn in proportion to its throughput; false where there is none.
  bool bounce(const ShadingPoint& point, const PassSampler& sampler, int depth, Vec3f& direction,
              Rgb& throughput) const;

  const Scene& scene_;
  Arrivals* arrivals_;  ///< null: nobody asks when light arrives
  /// For arrivals: where the path stands, and what counts of light there.
  double length_ = 0;
  Rgb throughput_{1};
  std::unique_ptr<MediumWalk> walk_;  ///< null: no media
  DirectLight direct_;
  int max_depth_;
  QueryCounters& counters_;
  uint64_t narrow_vertices_ = 0;
  std::vector<ScatterVertex> vertices_, far_vertices_;
  std::optional<MediumLines> lines_;
};

}  // namespace penumbra
