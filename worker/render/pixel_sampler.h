#pragma once
// One camera sample of one pixel in one pass of one mix: what run, pilot and `auto`'s pilot have in common.
#include "worker/render/camera.h"
#include "worker/render/path.h"
#include "worker/render/scene.h"
#include "worker/sampling/sampler.h"

namespace penumbra {

/// What a task renders with, whatever the mix.
struct Rendering {
  const Scene& scene;
  const JobSpec& job;
  const Camera& camera;
  TaskKind kind;
};

class PixelSampler {
 public:
  /// `index`: the mix's place in the job, which keys its random numbers; `mix` is what is rendered there.
  PixelSampler(const Rendering& rendering, const Mix& mix, size_t index, int64_t group)
      : rendering_(rendering),
        index_(uint32_t(index)),
        group_(group),
        prepared_(mix, rendering.scene.lights),
        tracer_(rendering.scene, prepared_, rendering.job.max_depth, counters_) {}
  PixelSampler(const PixelSampler&) = delete;  // the tracer refers to its neighbours

  /// Radiance times the filter's weight. May be NaN or infinite: whoever adds it up looks at that.
  Rgb sample(int x, int y, int64_t pass) {
    const JobSpec& job = rendering_.job;
    const uint32_t pixel = uint32_t(y) * uint32_t(job.width) + uint32_t(x);
    const PassSampler sampler(job.sampler, job.seed, index_, rendering_.kind, pixel, pass, group_);
    const FilterSample filter = rendering_.scene.filter->sample(sampler.film());
    const Vec2d at = Vec2d(x + 0.5, y + 0.5) + filter.offset;
    return tracer_.radiance(rendering_.camera.ray(at), sampler) * float(filter.weight);
  }

  QueryCounters& counters() { return counters_; }

 private:
  const Rendering& rendering_;
  uint32_t index_;
  int64_t group_;
  PreparedMix prepared_;
  QueryCounters counters_;
  PathTracer tracer_;
};

inline bool is_finite(const Rgb& c) {
  return std::isfinite(c.x) && std::isfinite(c.y) && std::isfinite(c.z);
}

/// CPU seconds of this thread (CLOCK_THREAD_CPUTIME_ID).
double thread_cpu_seconds();

}  // namespace penumbra
