#include "worker/render/integrand.h"

#include <cmath>
#include <limits>
#include <optional>

#include "proto/status.h"
#include "worker/render/camera.h"
#include "worker/render/surface.h"
#include "worker/render/thread_clock.h"
#include "worker/render/tile_accumulator.h"
#include "worker/strategies/direct_light.h"

namespace penumbra {
namespace {

/// The point that the probe's camera pixel sees; `bsdf` must outlive it.
struct Seen {
  SurfacePoint surface;
  Bsdf bsdf;
};

std::optional<Seen> seen_at(const Scene& scene, const Probe& probe, QueryCounters& counters) {
  const auto camera = Camera::build(scene.description, probe.camera_width, probe.camera_height);
  PENUMBRA_CHECK(camera.ok());  // build_scene() has tried it
  const CameraRay ray = camera->ray(Vec2d(probe.x + 0.5, probe.y + 0.5));
  const auto hit = scene.geometry->intersect(
      {ray.origin, ray.direction, 0, std::numeric_limits<float>::infinity()}, counters);
  if (!hit) return std::nullopt;
  const SurfacePoint surface = surface_at(scene, *hit, ray.direction, nullptr);
  const Bsdf bsdf = scene.materials.shade(scene.meshes[hit->id.mesh].material, surface, scene.textures);
  if (!bsdf.has_non_specular()) return std::nullopt;
  return Seen{surface, bsdf};
}

/// One strategy of one mix over the light.
class IntegrandRun {
 public:
  IntegrandRun(const Scene& scene, const JobSpec& job, const Seen& seen, size_t mix, QueryCounters& counters)
      : job_(job),
        light_(size_t(job.probe->light)),
        slot_(size_t(job.probe->slots[mix])),
        emitter_(scene.lights.area[light_]),
        mix_(job.mixes[mix], scene.lights),
        direct_({*scene.geometry, scene.lights}, mix_, counters),
        point_(seen.surface, seen.bsdf),
        view_(point_, emitter_) {}

  Rgb at(int x, int y) {
    const LightSample there =
        sample(AreaStrategy{}, view_, Vec2d((x + 0.5) / job_.width, (y + 0.5) / job_.height));
    if (!(there.at.pdf > 0) || slot_ >= mix_.slots()) return Rgb(0);
    const DirectLight::Integrand integrand = direct_.integrand(point_, light_, there.at.p);
    const double density = integrand.densities[slot_];
    return density > 0 ? integrand.f * float(integrand.weights[slot_] / density) : Rgb(0);
  }

 private:
  const JobSpec& job_;
  size_t light_, slot_;
  const AreaEmitter& emitter_;
  PreparedMix mix_;
  DirectLight direct_;
  ShadingPoint point_;
  LightView view_;
};

/// A pass over the tile; `run` is empty where there is nothing to see.
void draw_pass(std::optional<IntegrandRun>& run, const PixelRect& tile, TileAccumulator& pixels,
               MixCost& cost) {
  size_t pixel = 0;
  for (int y = tile.y0; y < tile.y1; ++y)
    for (int x = tile.x0; x < tile.x1; ++x) {
      Rgb value = run ? run->at(x, y) : Rgb(0);
      if (!(std::isfinite(value.x) && std::isfinite(value.y) && std::isfinite(value.z))) {
        ++cost.non_finite;
        value = Rgb(0);
      }
      pixels.add(pixel++, value, 1);
    }
}

}  // namespace

TaskOutcome render_integrand(const Scene& scene, const JobSpec& job, const TileTask& task,
                             const std::atomic<bool>& cancel) {
  TaskOutcome outcome;
  QueryCounters counters;
  const std::optional<Seen> seen = seen_at(scene, *job.probe, counters);
  const bool dark = !seen || size_t(job.probe->light) >= scene.lights.area.size();
  for (size_t m = 0; m < job.mixes.size(); ++m) {
    std::optional<IntegrandRun> run;
    if (!dark) run.emplace(scene, job, *seen, m, counters);
    TileAccumulator pixels(task.tile, task.group);
    MixCost cost;
    for (int64_t pass = task.passes[m].begin; pass < task.passes[m].end; ++pass) {
      if (cancel.load(std::memory_order_relaxed)) return {{}, {}, true};
      const double start = thread_cpu_seconds();
      draw_pass(run, task.tile, pixels, cost);
      const double seconds = thread_cpu_seconds() - start;
      pixels.end_pass(pass, seconds);
      cost.cpu_seconds += seconds;
      ++cost.passes;
    }
    pixels.finish();
    outcome.pixels.mixes.push_back(pixels.pixels());
    outcome.costs.push_back(cost);
  }
  return outcome;
}

}  // namespace penumbra
