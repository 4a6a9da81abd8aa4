#include "worker/render/medium_lines.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "worker/lights/spot_cone.h"
#include "worker/strategies/light_hit.h"

namespace penumbra {
namespace {

/// PassSampler::branch of what is drawn here.
constexpr int kLineBranch = 1 << 21;

/// Is it infinitely far away?
bool is_far(const LightSet& lights, size_t light) {
  if (light < lights.area.size()) return false;
  const size_t behind = light - lights.area.size();
  return behind < lights.environments.size() ||
         std::holds_alternative<DistantEmitter>(lights.delta[behind - lights.environments.size()]);
}

LightSet far_lights(const Scene& scene) {
  LightSet far;
  far.environments = scene.lights.environments;
  for (const DeltaEmitter& e : scene.lights.delta)
    if (std::holds_alternative<DistantEmitter>(e)) far.delta.push_back(e);
  far.by_mesh.resize(scene.meshes.size());
  far.finish(scene.lights.reach(), scene.lights.centre());
  return far;
}

}  // namespace

MediumLines::Far::Far(const Scene& scene, const PreparedMix& prepared, MediumWalk* walk,
                      QueryCounters& counters, Arrivals* arrivals)
    : lights(far_lights(scene)),
      mix(prepared.mix(), lights, !scene.lights.area.empty()),
      direct({*scene.geometry, lights, walk, arrivals}, mix, counters) {}

MediumLines::MediumLines(const Scene& scene, const PreparedMix& mix, MediumWalk* walk,
                         QueryCounters& counters, Arrivals* arrivals)
    : scene_(scene),
      now_(scene.lights, nullptr),
      count_(mix.samples()),
      walk_(*walk),
      counters_(counters),
      arrivals_(arrivals) {
  for (size_t l = 0; l < scene.lights.size() && !far_; ++l)
    if (is_far(scene.lights, l)) far_ = std::make_unique<Far>(scene, mix, walk, counters, arrivals);
}

double MediumLines::end(const Vec3f& origin) const {
  Vec3f lo, hi;
  scene_.geometry->bounds(lo, hi);
  if (!(lo.x <= hi.x)) return 2 * double(scene_.lights.reach());
  return (Vec3d(lo) * 0.5 + Vec3d(hi) * 0.5 - Vec3d(origin)).length() + 2 * double(scene_.lights.reach());
}

Rgb MediumLines::estimate(const Ray& ray, double until, const Start& start, const PassSampler& sampler,
                          int depth) {
  time_ = ray.time;
  const PassSampler numbers = sampler.branch(kLineBranch);
  const LightSet& lights = scene_.lights;
  const size_t parts = walk_.parts().size();
  Rgb sum(0);
  const auto ask = [&](size_t light, double weight, int i, int n) {
    Apex apex = choose(light, numbers.light(depth, uint32_t(lights.draws() ? 0 : light), 0, i, n));
    if (apex.weight == 0) return;
    apex.weight *= weight;
    for (size_t part = 0; part < parts; ++part)
      sum += along(apex, ray, start, part, until,
                   numbers.line(depth, uint32_t(lights.draws() ? 0 : light), int(part), i, n));
  };
  if (!lights.draws()) {
    for (size_t l = 0; l < lights.size(); ++l)
      if (!is_far(lights, l))
        for (int i = 0; i < count_; ++i) ask(l, 1.0 / count_, i, count_);
    return sum;
  }
  // Half of them by what they bring to the middle of the segment, half uniformly: a cone or a light's back
  // may leave out the middle and light the rest.
  const int draws = LightSet::kMostAsked;
  const double middle = 0.5 * std::min(until, double(lights.reach()));
  const Receiver receiver{Vec3d(ray.origin) + Vec3d(ray.direction) * middle, false, Vec3d(0)};
  const auto size = double(lights.size());
  for (int d = 0; d < draws; ++d) {
    const double u = numbers.draw(depth, d, draws);
    const DrawnLight drawn = u < 0.5 ? lights.draw(receiver, 2 * u) : DrawnLight{};
    if (u < 0.5 && !(drawn.probability > 0)) continue;  // none that the middle knows of
    const size_t light = u < 0.5 ? drawn.light : std::min(size_t((2 * u - 1) * size), lights.size() - 1);
    const double probability = 0.5 * lights.probability(receiver, light) + 0.5 / size;
    if (is_far(lights, light)) continue;
    for (int i = 0; i < count_; ++i)
      ask(light, 1 / (draws * count_ * probability), d * count_ + i, draws * count_);
  }
  return sum;
}

MediumLines::Apex MediumLines::choose(size_t light, const Vec2d& u) {
  const LightSet& lights = scene_.lights;
  Apex apex;
  apex.light = light;
  if (light < lights.area.size()) {
    const LightPoint at = sample_area(area_light(light).shape, Vec3d(0), u);
    apex.p = at.p;
    apex.n = at.n;
    apex.weight =
        in_hole(*scene_.geometry, area_light(light), at.p, time_) ? 0 : area(area_light(light).shape);
    return apex;
  }
  const DeltaEmitter& emitter = lights.delta[light - lights.area.size() - lights.environments.size()];
  if (const auto* point = std::get_if<PointEmitter>(&emitter))
    apex.p = Vec3d(point->position);
  else
    apex.p = Vec3d(std::get<SpotEmitter>(emitter).position);
  return apex;
}

bool MediumLines::clip_to_lit(const Apex& apex, const Ray& ray, double& t0, double& t1) const {
  const LightSet& lights = scene_.lights;
  if (apex.light >= lights.area.size()) {
    const size_t delta = apex.light - lights.area.size() - lights.environments.size();
    const auto* const spot = std::get_if<SpotEmitter>(&lights.delta[delta]);
    return spot ? clip_to_cone(*spot, Vec3d(ray.origin), Vec3d(ray.direction), t0, t1) : t0 < t1;
  }
  const double height = apex.n.dot(Vec3d(ray.origin) - apex.p), slope = apex.n.dot(Vec3d(ray.direction));
  if (slope == 0) return height > 0 && t0 < t1;
  const double crossing = -height / slope;
  if (slope > 0)
    t0 = std::max(t0, crossing);
  else
    t1 = std::min(t1, crossing);
  return t0 < t1;
}

/// The apex moved off its light's plane by what a fan's sides may be wrong by, as end_on_light() moves the
/// ends of shadow segments: a surface in that plane hides nothing in front of it.
static Vec3f off_the_light(const Vec3d& p, const Vec3d& n, const Vec3d& far_end) {
  const double largest = std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) + (far_end - p).length();
  return Vec3f(p + n * (16 * double(std::numeric_limits<float>::epsilon()) * largest));
}

void MediumLines::find_visible(const Apex& apex, const Ray& ray, double t0, double t1) {
  const LightSet& lights = scene_.lights;
  LineQuery query;
  query.x = off_the_light(apex.p, apex.n, Vec3d(ray.origin) + Vec3d(ray.direction) * t1);
  query.a = ray.origin + ray.direction * float(t0);
  query.b = ray.origin + ray.direction * float(t1);
  query.time = ray.time;
  if (apex.light < lights.area.size()) {
    const AreaEmitter& emitter = lights.area[apex.light];
    query.light = {emitter.instance, emitter.mesh, emitter.first_primitive};
    query.light_primitives = emitter.primitives;
  }
  scene_.geometry->visible({&query, 1}, visible_, counters_);
}

Rgb MediumLines::arriving(const Apex& apex, const Vec3f& x, Vec3f& wi, double& distance) {
  const LightSet& lights = scene_.lights;
  if (apex.light >= lights.area.size()) {
    const DeltaLight light = delta_light_at(
        lights.delta[apex.light - lights.area.size() - lights.environments.size()], x, lights.reach());
    wi = light.wi;
    distance = (apex.p - Vec3d(x)).length();
    return light.irradiance;
  }
  const Vec3d to_light = apex.p - Vec3d(x);
  distance = to_light.length();
  wi = Vec3f(to_light / distance);
  const double cosine = -apex.n.dot(to_light) / distance;
  return lights.area[apex.light].radiance * float(std::max(cosine, 0.0) / (distance * distance));
}

Rgb MediumLines::along(const Apex& apex, const Ray& ray, const Start& start, size_t part, double until,
                       double u) {
  const MediumPart& in = walk_.parts()[part];
  double t0 = in.t0, t1 = std::min(in.t1, until);
  if (!(t0 < t1) || !clip_to_lit(apex, ray, t0, t1)) return Rgb(0);
  find_visible(apex, ray, t0, t1);
  angles_.clear();
  double total = 0;
  for (const Interval& v : visible_[0]) {
    const double a = t0 + (t1 - t0) * double(v.lo), b = v.hi == 1 ? t1 : t0 + (t1 - t0) * double(v.hi);
    angles_.emplace_back(MediumRay{Vec3d(ray.origin), Vec3d(ray.direction), a, b}, apex.p);
    if (!angles_.back().possible())
      angles_.pop_back();
    else
      total += angles_.back().angle();
  }
  if (angles_.empty()) return Rgb(0);
  double rest = u * total;
  size_t chosen = 0;
  while (chosen + 1 < angles_.size() && rest >= angles_[chosen].angle()) rest -= angles_[chosen++].angle();
  const Equiangular& interval = angles_[chosen];
  const double t = interval.sample(std::min(rest / interval.angle(), 1.0));
  // Uniform in all the angles: the density is that of its own interval, times its share of them.
  const double density = interval.pdf(t) * (interval.angle() / total);
  if (!(density > 0)) return Rgb(0);
  const Vec3f x(Vec3d(ray.origin) + Vec3d(ray.direction) * t);
  if (apex.light < scene_.lights.area.size() &&
      behind_own_wall(area_light(apex.light).shape, apex.p, Vec3d(x)))
    return Rgb(0);
  Vec3f wi;
  double distance = 0;
  Rgb f = arriving(apex, x, wi, distance);
  if (!(f.x + f.y + f.z > 0)) return Rgb(0);
  walk_.stand_in(in.medium);
  f *= in.phase->scatter(-ray.direction, wi) * walk_.scattering(part, t) *
       walk_.transmittance(x, wi, distance);
  if (scene_.geometry->has_alpha() &&
      scene_.geometry->occluded_by_alpha(x, off_the_light(apex.p, apex.n, Vec3d(x)), counters_, ray.time))
    return Rgb(0);
  f *= float(apex.weight / density);
  if (arrivals_ != nullptr) {
    arrivals_->stand_at(start.length + t, start.throughput);
    arrivals_->add(distance, f);
  }
  return f;
}

}  // namespace penumbra
