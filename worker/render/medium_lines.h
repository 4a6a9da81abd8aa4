#pragma once
// `/medium=line`: single scattering lit by lines. A point of a light comes first; of the camera's segment it
// lights visible intervals of a fan with the point as apex, which one line query gives exactly; the place
// where light is scattered is drawn on those alone, uniform in the angle at the point (Equiangular, cut to
// the intervals).
#include <memory>
#include <vector>

#include "worker/effects/medium.h"
#include "worker/render/medium_stage.h"
#include "worker/render/scene.h"
#include "worker/strategies/direct_light.h"
#include "worker/strategies/lights_now.h"

namespace penumbra {

class MediumLines {
 public:
  /// For arrivals: the path's length at the ray's origin, and what counts of light from the ray.
  struct Start {
    double length;
    Rgb throughput;
  };
  /// Of each light and segment as many points as the mix has light samples.
  MediumLines(const Scene& scene, const PreparedMix& mix, MediumWalk* walk, QueryCounters& counters,
              Arrivals* arrivals);

  /// What lights at a finite distance make media scatter towards the ray's origin, on the parts of the walk's
  /// last pass() up to `until`. Leaves the walk standing anywhere.
  Rgb estimate(const Ray& ray, double until, const Start& start, const PassSampler& sampler, int depth);
  /// How far chords of a ray from there reach.
  double end(const Vec3f& origin) const;
  /// Lights infinitely far away, which have no point for a line to start from; null: there are none.
  DirectLight* far() { return far_ ? &far_->direct : nullptr; }

 private:
  /// A point of a light, from which lines start.
  struct Apex {
    size_t light = 0;  ///< area emitters first, then environments, then delta
    Vec3d p;
    Vec3d n{0, 0, 0};   ///< of an area light; 0: it shines everywhere
    double weight = 1;  ///< 1 / (number × density per area)
  };
  Apex choose(size_t light, const Vec2d& u);
  /// An area light at the ray's time.
  const AreaEmitter& area_light(size_t light) { return now_.at(light, time_); }
  Rgb along(const Apex& apex, const Ray& ray, const Start& start, size_t part, double until, double u);
  /// The part of [t0,t1] that the light may shine on: in front of an area light, in a spot's cone.
  bool clip_to_lit(const Apex& apex, const Ray& ray, double& t0, double& t1) const;
  void find_visible(const Apex& apex, const Ray& ray, double t0, double t1);
  /// Radiance × cosine / squared distance from the apex at x, or what a light without extent gives.
  Rgb arriving(const Apex& apex, const Vec3f& x, Vec3f& wi, double& distance);

  /// The far lights as a set of their own.
  struct Far {
    Far(const Scene& scene, const PreparedMix& mix, MediumWalk* walk, QueryCounters& counters,
        Arrivals* arrivals);
    LightSet lights;
    PreparedMix mix;
    DirectLight direct;
  };

  const Scene& scene_;
  LightsNow now_;
  float time_ = 0;
  int count_;
  MediumWalk& walk_;
  QueryCounters& counters_;
  Arrivals* arrivals_;  ///< null: nobody asks when light arrives
  std::vector<IntervalSet> visible_;
  std::vector<Equiangular> angles_;  ///< of the visible intervals
  std::unique_ptr<Far> far_;         ///< `direct` refers to its neighbours: it must not move
};

}  // namespace penumbra
