#include "worker/render/path.h"

#include <algorithm>
#include <array>
#include <limits>

#include "worker/render/surface.h"
#include "worker/strategies/light_hit.h"
#include "worker/strategies/light_pivot.h"

namespace penumbra {
namespace {

// select(depth, i): the specular choice, which light media are looked through for.
constexpr int kSpecularChoice = 0, kPivotLight = 1;
// light(depth, …): a stream that is no light's and no strategy's.
constexpr uint32_t kPivotStream = 0xfffffffe;
// branch(i): what lights infinitely far away make media scatter, where the others do it by lines.
constexpr int kFarBranch = 1 << 22;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

float largest(const Rgb& c) {
  return std::max({c.x, c.y, c.z});
}

Ray first_ray(const CameraRay& ray) {
  return {ray.origin, ray.direction, 0, std::numeric_limits<float>::infinity(), ray.time};
}

}  // namespace

Rgb PathTracer::radiance(const CameraRay& camera_ray, const PassSampler& sampler, bool emission) {
  Rgb sum(0), throughput(1);
  Ray ray = first_ray(camera_ray);
  length_ = 0;
  if (walk_) walk_->start();
  for (int depth = 0;; ++depth) {
    const auto hit = scene_.geometry->intersect(ray, counters_);
    if (arrivals_) throughput_ = throughput;
    if (walk_) sum += scattered(ray, hit ? double(hit->distance) : kInfinity, sampler, depth, throughput);
    if (!hit) return sum + throughput * background(ray);
    if (arrivals_) {
      length_ += double(hit->distance);
      arrivals_->stand_at(length_, throughput);
    }
    if (emission || depth > 0) sum += throughput * arrived(*hit, ray);
    const bool filters = scene_.footprints && depth == 0;
    const SurfacePoint surface = surface_at(scene_, *hit, ray.direction, filters ? &camera_ray : nullptr);
    const Bsdf bsdf = scene_.materials.shade(scene_.meshes[hit->id.mesh].material, surface, scene_.textures);
    const ShadingPoint point(surface, bsdf);
    if (walk_) walk_->stand_on(hit->id.mesh, surface.ng);
    narrow_vertices_ += bsdf.has_narrow_lobe();
    if (bsdf.has_non_specular()) sum += throughput * direct_.estimate(point, sampler, depth);
    if (depth + 1 >= max_depth_ || bsdf.specular_count() == 0) return sum;
    Vec3f direction;
    if (!bounce(point, sampler, depth, direction, throughput)) return sum;
    ray = {surface.offset(direction), direction, 0, std::numeric_limits<float>::infinity(), camera_ray.time};
    if (walk_) walk_->leave(direction);
  }
}

Rgb PathTracer::emission(const CameraRay& camera_ray) {
  const Ray ray = first_ray(camera_ray);
  const auto hit = scene_.geometry->intersect(ray, counters_);
  if (!hit) return Rgb(0);
  Rgb passes(1);
  if (walk_) {
    walk_->start();
    passes = walk_->pass(ray, double(hit->distance), nullptr, vertices_);
  }
  if (arrivals_) arrivals_->stand_at(double(hit->distance), passes);
  return arrived(*hit, ray) * passes;
}

Rgb PathTracer::scattered(const Ray& ray, double distance, const PassSampler& sampler, int depth,
                          Rgb& throughput) {
  Rgb left(0);
  const Rgb sum = throughput * (lines_ ? scattered_by_lines(ray, distance, sampler, depth, left)
                                       : scattered_by_points(ray, distance, sampler, depth, left));
  walk_->arrive();
  throughput *= left;
  return sum;
}

Rgb PathTracer::scattered_by_points(const Ray& ray, double distance, const PassSampler& sampler, int depth,
                                    Rgb& left) {
  const LightSet& lights = scene_.lights;
  const double middle = 0.5 * std::min(distance, double(lights.reach()));
  const auto pivot =
      light_pivot(lights, Vec3d(ray.origin) + Vec3d(ray.direction) * middle,
                  sampler.select(depth, kPivotLight), sampler.light(depth, kPivotStream, 0, 0, 1));
  const ScatterDraw draw{sampler, depth, pivot};
  vertices_.clear();
  left = walk_->pass(ray, distance, &draw, vertices_);
  return lit(vertices_, ray, depth, direct_);
}

Rgb PathTracer::scattered_by_lines(const Ray& ray, double distance, const PassSampler& sampler, int depth,
                                   Rgb& left) {
  // A chord has an end: past it, which is far beyond all surfaces, and for lights infinitely far away,
  // points.
  const double until = std::min(distance, lines_->end(ray.origin));
  const ScatterDraw before{sampler.branch(kFarBranch), depth, std::nullopt, 0, until};
  const ScatterDraw beyond{sampler, depth, std::nullopt, until};
  vertices_.clear();
  far_vertices_.clear();
  if (lines_->far() != nullptr) walk_->pass(ray, distance, &before, far_vertices_);
  left = walk_->pass(ray, distance, until < distance ? &beyond : nullptr, vertices_);
  Rgb sum = lines_->estimate(ray, until, {length_, throughput_}, sampler, depth) +
            lit(vertices_, ray, depth, direct_);
  if (lines_->far() != nullptr) sum += lit(far_vertices_, ray, depth, *lines_->far());
  return sum;
}

Rgb PathTracer::lit(const std::vector<ScatterVertex>& vertices, const Ray& ray, int depth,
                    DirectLight& direct) {
  Rgb sum(0);
  for (const ScatterVertex& vertex : vertices) {
    walk_->stand_in(vertex.medium);
    const ShadingPoint point(vertex.p, -ray.direction, *vertex.phase, ray.time);
    narrow_vertices_ += vertex.phase->has_narrow_lobe();
    if (arrivals_)
      arrivals_->stand_at(length_ + (Vec3d(vertex.p) - Vec3d(ray.origin)).length(),
                          throughput_ * vertex.weight);
    sum += vertex.weight * direct.estimate(point, vertex.sampler, depth);
  }
  return sum;
}

Rgb PathTracer::emitted(const Hit& hit, const Ray& ray) {
  if (scene_.lights.area.empty()) return Rgb(0);
  const auto met = light_met(*scene_.geometry, scene_.lights, ray, hit, counters_);
  return met ? scene_.lights.area[met->emitter].radiance : Rgb(0);
}

Rgb PathTracer::arrived(const Hit& hit, const Ray& ray) {
  const Rgb light = emitted(hit, ray);
  if (arrivals_) arrivals_->add(0, light);
  return light;
}

Rgb PathTracer::background(const Ray& ray) const {
  Rgb sum(0);
  for (const Environment& e : scene_.lights.environments) sum += e.radiance(Vec3d(ray.origin), ray.direction);
  return sum;
}

bool PathTracer::bounce(const ShadingPoint& point, const PassSampler& sampler, int depth, Vec3f& direction,
                        Rgb& throughput) const {
  std::array<BsdfSample, Bsdf::kMostLobes> samples;
  std::array<float, Bsdf::kMostLobes> weights{};
  int n = 0;
  float total = 0;
  for (int i = 0; i < point.bsdf->specular_count(); ++i) {
    const auto s = point.bsdf->sample_specular(point.wo, i);
    if (!s || !(s->pdf > 0)) continue;
    samples[size_t(n)] = *s;
    weights[size_t(n)] = largest(s->f) * std::abs(s->wi.dot(point.bsdf->ns())) / float(s->pdf);
    total += weights[size_t(n++)];
  }
  if (!(total > 0)) return false;
  float target = float(sampler.select(depth, kSpecularChoice)) * total;
  int chosen = 0;
  while (chosen + 1 < n && target >= weights[size_t(chosen)]) target -= weights[size_t(chosen++)];
  const BsdfSample& s = samples[size_t(chosen)];
  if (!(weights[size_t(chosen)] > 0)) return false;
  direction = s.wi;
  const float cosine = std::abs(s.wi.dot(point.bsdf->ns()));
  throughput *= s.f * (cosine / float(s.pdf) * total / weights[size_t(chosen)]);
  return true;
}

}  // namespace penumbra
