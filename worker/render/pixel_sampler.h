#pragma once
// One camera sample of one pixel in one pass of one mix: what run, pilot and `auto`'s pilot have in common.
#include <cmath>
#include <memory>
#include <vector>

#include "worker/effects/transient.h"
#include "worker/render/camera.h"
#include "worker/render/camera_stage.h"
#include "worker/render/light_pixels.h"
#include "worker/render/path.h"
#include "worker/render/pixel_lines.h"
#include "worker/render/scene.h"
#include "worker/render/thread_clock.h"
#include "worker/sampling/sampler.h"

namespace penumbra {

/// What a task renders with, whatever the mix.
struct Rendering {
  const Scene& scene;
  const JobSpec& job;
  const Camera& camera;
  TaskKind kind;
  PixelRect tile;
  std::vector<uint8_t> light_pixels;  ///< of the tile (light_pixels.h)
};

/// Camera rays of a pass for the emission of a pixel that may see a light. Its variance falls with their
/// number, and such a pixel has little else to pay for.
constexpr int kEmissionRays = 16;

/// Probes look at pixel centres.
inline const Filter kCentreFilter = Filter::centre();

class PixelSampler {
 public:
  /// `index`: the mix's place in the job, which keys its random numbers; `mix` is what is rendered there.
  PixelSampler(const Rendering& rendering, const Mix& mix, size_t index, int64_t group)
      : rendering_(rendering),
        filter_(rendering.job.probe ? kCentreFilter : *rendering.scene.filter),
        mix_(mix),
        index_(uint32_t(index)),
        group_(group),
        stage_(rendering.job.probe ? nullptr : rendering.scene.effects.camera.get()),
        lines_(mix.pixel == PixelSampling::kLine && !stage_ && !rendering.job.probe &&
               !(rendering.job.camera_grid > 0)),
        prepared_(mix, rendering.scene.lights),
        bins_(rendering.job.transient ? std::make_unique<TimeBins>(*rendering.job.transient) : nullptr),
        tracer_(rendering.scene, prepared_, rendering.job.max_depth, counters_, bins_.get()) {}
  PixelSampler(const PixelSampler&) = delete;  // the tracer refers to its neighbours

  /// Radiance times the filter's weight at a pixel of the tile. May be NaN or infinite: whoever adds it up
  /// looks at that.
  Rgb sample(int x, int y, int64_t pass) {
    if (bins_) bins_->clear();
    const JobSpec& job = rendering_.job;
    const PixelRect& tile = rendering_.tile;
    const uint32_t pixel = uint32_t(y) * uint32_t(job.width) + uint32_t(x);
    const PassSampler sampler(job.sampler, job.seed, index_, rendering_.kind, pixel, pass, group_);
    const Vec2d centre(x + 0.5, y + 0.5);
    const bool apart =
        rendering_.light_pixels[size_t(y - tile.y0) * size_t(tile.width()) + size_t(x - tile.x0)] != 0;
    Rgb value(0);
    if (lines_) {
      value = across(centre, sampler, !apart);
    } else {
      const FilterSample filter = filter_.sample(sampler.film());
      value = radiance(ray(centre, filter), sampler, !apart, filter.weight) * float(filter.weight);
    }
    if (apart) value += emission(centre, sampler);
    return value;
  }

  QueryCounters& counters() { return counters_; }
  /// Of all samples so far: see PathTracer.
  uint64_t narrow_vertices() const { return tracer_.narrow_vertices(); }
  /// Where the last sample's light went by the length of its path; null: nobody asks.
  TimeBins* bins() { return bins_.get(); }

 private:
  CameraRay ray(const Vec2d& centre, const FilterSample& filter) const {
    Vec2d at = centre + filter.offset;
    if (const double cells = rendering_.job.camera_grid; cells > 0)
      at = Vec2d(std::floor(at.x * cells) + 0.5, std::floor(at.y * cells) + 0.5) / cells;
    return rendering_.camera.ray(at);
  }

  /// By the stretches of a line across the pixel.
  Rgb across(const Vec2d& centre, const PassSampler& sampler, bool emission) {
    looks_across_pixel(rendering_.camera, filter_, centre, sampler, *rendering_.scene.geometry, counters_,
                       looks_);
    Rgb sum(0);
    for (size_t k = 0; k < looks_.size(); ++k) {
      if (bins_) bins_->weigh(looks_[k].weight);
      sum += tracer_.radiance(ray(centre, looks_[k]), sampler.branch(int(k)), emission) *
             float(looks_[k].weight);
    }
    return sum;
  }

  /// Mean emission over the pixel's filter, from rays of its own.
  Rgb emission(const Vec2d& centre, const PassSampler& sampler) {
    Rgb sum(0);
    const int n = stage_ ? stage_->emission_samples(mix_, kEmissionRays) : kEmissionRays;
    for (int i = 0; i < n; ++i) {
      const FilterSample filter = filter_.sample(sampler.film(i, n));
      sum += emission(ray(centre, filter), sampler, i, n, filter.weight / n) * float(filter.weight);
    }
    return sum / float(n);
  }

  /// `weight`: what the caller makes of it, for the bins.
  Rgb radiance(const CameraRay& pinhole, const PassSampler& sampler, bool emission, double weight) {
    if (bins_) bins_->weigh(weight);
    if (!stage_) return tracer_.radiance(pinhole, sampler, emission);
    stage_->rays(pinhole, {sampler, mix_, *rendering_.scene.geometry, counters_}, rays_);
    Rgb sum(0);
    for (size_t k = 0; k < rays_.size(); ++k) {
      if (bins_) bins_->weigh(weight * double(rays_[k].weight));
      sum += tracer_.radiance(rays_[k].ray, sampler.branch(int(k)), emission) * rays_[k].weight;
    }
    return sum;
  }

  Rgb emission(const CameraRay& pinhole, const PassSampler& sampler, int i, int n, double weight) {
    if (bins_) bins_->weigh(weight);
    if (!stage_) return tracer_.emission(pinhole);
    stage_->rays(pinhole, {sampler, mix_, *rendering_.scene.geometry, counters_, i, n}, rays_);
    Rgb sum(0);
    for (const WeightedRay& seen : rays_) {
      if (bins_) bins_->weigh(weight * double(seen.weight));
      sum += tracer_.emission(seen.ray) * seen.weight;
    }
    return sum;
  }

  const Rendering& rendering_;
  const Filter& filter_;
  Mix mix_;
  uint32_t index_;
  int64_t group_;
  const CameraStage* stage_;  ///< null: a pinhole
  bool lines_;                ///< across the pixel
  std::vector<FilterSample> looks_;
  std::vector<WeightedRay> rays_;
  PreparedMix prepared_;
  QueryCounters counters_;
  std::unique_ptr<TimeBins> bins_;  ///< null: the job has no --transient
  PathTracer tracer_;
};

inline bool is_finite(const Rgb& c) {
  return std::isfinite(c.x) && std::isfinite(c.y) && std::isfinite(c.z);
}

}  // namespace penumbra
