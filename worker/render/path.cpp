#include "worker/render/path.h"

#include <algorithm>
#include <array>
#include <limits>

#include "worker/render/surface.h"
#include "worker/strategies/light_hit.h"

namespace penumbra {
namespace {

// select(depth, i): the specular choice.
constexpr int kSpecularChoice = 0;

float largest(const Rgb& c) { return std::max({c.x, c.y, c.z}); }

Ray first_ray(const CameraRay& ray) {
  return {ray.origin, ray.direction, 0, std::numeric_limits<float>::infinity()};
}

}  // namespace

Rgb PathTracer::radiance(const CameraRay& camera_ray, const PassSampler& sampler, bool emission) {
  Rgb sum(0), throughput(1);
  Ray ray = first_ray(camera_ray);
  for (int depth = 0;; ++depth) {
    const auto hit = scene_.geometry->intersect(ray, counters_);
    if (!hit) return sum + throughput * background(ray.direction);
    if (emission || depth > 0) sum += throughput * emitted(*hit, ray);
    const bool filters = scene_.footprints && depth == 0;
    const SurfacePoint surface = surface_at(scene_, *hit, ray.direction, filters ? &camera_ray : nullptr);
    const Bsdf bsdf = scene_.materials.shade(scene_.meshes[hit->id.mesh].material, surface, scene_.textures);
    const ShadingPoint point(surface, bsdf);
    if (bsdf.has_non_specular()) sum += throughput * direct_.estimate(point, sampler, depth);
    if (depth + 1 >= max_depth_ || bsdf.specular_count() == 0) return sum;
    Vec3f direction;
    if (!bounce(point, sampler, depth, direction, throughput)) return sum;
    ray = {surface.offset(direction), direction, 0, std::numeric_limits<float>::infinity()};
  }
}

Rgb PathTracer::emission(const CameraRay& camera_ray) {
  const Ray ray = first_ray(camera_ray);
  const auto hit = scene_.geometry->intersect(ray, counters_);
  return hit ? emitted(*hit, ray) : Rgb(0);
}

Rgb PathTracer::emitted(const Hit& hit, const Ray& ray) {
  if (scene_.lights.area.empty()) return Rgb(0);
  const auto met = light_met(*scene_.geometry, scene_.lights, ray, hit, counters_);
  return met ? scene_.lights.area[met->emitter].radiance : Rgb(0);
}

Rgb PathTracer::background(const Vec3f& direction) const {
  Rgb sum(0);
  for (const Environment& e : scene_.lights.environments) sum += e.radiance(direction);
  return sum;
}

bool PathTracer::bounce(const ShadingPoint& point, const PassSampler& sampler, int depth, Vec3f& direction,
                        Rgb& throughput) const {
  std::array<BsdfSample, Bsdf::kMostLobes> samples;
  std::array<float, Bsdf::kMostLobes> weights{};
  int n = 0;
  float total = 0;
  for (int i = 0; i < point.bsdf.specular_count(); ++i) {
    const auto s = point.bsdf.sample_specular(point.wo, i);
    if (!s || !(s->pdf > 0)) continue;
    samples[size_t(n)] = *s;
    weights[size_t(n)] = largest(s->f) * std::abs(s->wi.dot(point.bsdf.ns())) / float(s->pdf);
    total += weights[size_t(n++)];
  }
  if (!(total > 0)) return false;
  float target = float(sampler.select(depth, kSpecularChoice)) * total;
  int chosen = 0;
  while (chosen + 1 < n && target >= weights[size_t(chosen)]) target -= weights[size_t(chosen++)];
  const BsdfSample& s = samples[size_t(chosen)];
  if (!(weights[size_t(chosen)] > 0)) return false;
  direction = s.wi;
  const float cosine = std::abs(s.wi.dot(point.bsdf.ns()));
  throughput *= s.f * (cosine / float(s.pdf) * total / weights[size_t(chosen)]);
  return true;
}

}  // namespace penumbra
