#include "worker/render/pixel_sampler.h"

#include <cmath>

namespace penumbra {
namespace {

/// Camera rays of a pass for the emission of a pixel that may see a light. Its variance falls with their number,
/// and such a pixel has little else to pay for.
constexpr int kEmissionRays = 16;

/// Probes look at pixel centres.
const Filter kCentre = Filter::centre();

}  // namespace

Rendering::Rendering(const Scene& scene_, const JobSpec& job_, const Camera& camera, const TileTask& task)
    : scene(scene_),
      job(job_),
      kind(task.kind),
      filter(job_.probe ? kCentre : *scene_.filter),
      camera_(camera),
      tile_(task.tile),
      light_pixels_(light_pixels(scene_, camera, task.tile)) {}

CameraRay Rendering::ray(int x, int y, const FilterSample& sample) const {
  Vec2d at = Vec2d(x + 0.5, y + 0.5) + sample.offset;
  if (const double cells = job.camera_grid; cells > 0)
    at = Vec2d(std::floor(at.x * cells) + 0.5, std::floor(at.y * cells) + 0.5) / cells;
  return camera_.ray(at);
}

Rgb PixelSampler::sample(int x, int y, int64_t pass) {
  const JobSpec& job = rendering_.job;
  const uint32_t pixel = uint32_t(y) * uint32_t(job.width) + uint32_t(x);
  const PassSampler sampler(job.sampler, job.seed, index_, rendering_.kind, pixel, pass, group_);
  const FilterSample at = rendering_.filter.sample(sampler.film());
  const bool apart = rendering_.sees_light(x, y);
  const Rgb value = tracer_.radiance(rendering_.ray(x, y, at), sampler, !apart) * float(at.weight);
  return apart ? value + emission(x, y, sampler) : value;
}

/// Mean emission over the pixel's filter, from rays of its own.
Rgb PixelSampler::emission(int x, int y, const PassSampler& sampler) {
  Rgb sum(0);
  for (int i = 0; i < kEmissionRays; ++i) {
    const FilterSample at = rendering_.filter.sample(sampler.film(i, kEmissionRays));
    sum += tracer_.emission(rendering_.ray(x, y, at)) * float(at.weight);
  }
  return sum / float(kEmissionRays);
}

}  // namespace penumbra
