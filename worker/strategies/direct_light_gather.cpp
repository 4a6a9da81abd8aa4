// What the strategies of a mix find: candidates for light, on their way to their weights.
#include <limits>

#include "worker/strategies/direct_light.h"
#include "worker/strategies/light_hit.h"

namespace penumbra {
namespace {

/// Stream of random numbers for the material's directions: they belong to no single light.
constexpr uint32_t kBsdfStream = 0xffffffff;

}  // namespace

/// Traces the directions of the mix's bsdf samples once, for all lights, and keeps those that met one.
void DirectLight::trace_bsdf(const ShadingPoint& point, const PassSampler& sampler, int depth) {
  hits_.clear();
  const LightSet& lights = scene_.lights;
  for (size_t s = 0; s < mix_.slots(); ++s) {
    const int count = mix_.directions(s);
    for (int i = 0; i < count; ++i) {
      const Vec2d u = sampler.light(depth, kBsdfStream, int(s), i, count);
      const auto scattered =
          point.scattering.sample(point.wo, u, sampler.choice(depth, kBsdfStream, int(s), i, count));
      if (!scattered || !(scattered->pdf > 0)) continue;
      const Vec3f& wi = scattered->wi;
      const Ray ray{point.origin(wi), wi, 0, std::numeric_limits<float>::infinity(), point.time};
      BsdfHit found;
      found.slot = s;
      found.sample.wi = wi;
      const auto hit = scene_.geometry.intersect(ray, counters_);
      if (!hit) {
        for (size_t e = 0; e < lights.environments.size(); ++e) {
          found.light = lights.area.size() + e;
          const LightView view = view_of(point, found.light);
          found.sample.radiance = view.environment().radiance(view.x(), wi);
          if (is_black(found.sample.radiance)) continue;
          found.sample.at = {view.far_along(wi), Vec3d(0), scattered->pdf};
          hits_.push_back(found);
        }
        continue;
      }
      const auto met = light_met(scene_.geometry, lights, ray, *hit, counters_);
      if (!met) continue;
      const AreaEmitter& light = now_.at(met->emitter, point.time);
      found.light = met->emitter;
      found.sample.radiance = light.radiance;
      found.sample.at = {met->p, emission_normal(light.shape, met->p), scattered->pdf};
      hits_.push_back(found);
    }
  }
}

void DirectLight::gather_bsdf(const Task& task) {
  const auto mine = [&](const BsdfHit& hit) { return hit.light == task.light; };
  for (const BsdfHit& hit : hits_)
    if (mine(hit)) push(task, hit.sample, hit.slot, Sight::kTraced, kNoLine, 0);
  std::erase_if(hits_, mine);
}

Vec2d DirectLight::numbers(const Task& task, size_t slot, int turn, int i, const PassSampler& sampler,
                           int depth) const {
  const PreparedMix::Slot s = task.slot(mix_, slot);
  const int sample = turn * s.count + i, in_all = task.draws_in_all * s.count;
  if (!is_analytic(s.strategy)) return sampler.light(depth, task.stream, int(slot), sample, in_all);
  return {sampler.line(depth, task.stream, int(slot), sample, in_all),
          sampler.choice(depth, task.stream, int(slot), sample, in_all)};
}

void DirectLight::gather_points(const Task& task, const PassSampler& sampler, int depth) {
  for (size_t s = 0; s < mix_.slots(); ++s) {
    const PreparedMix::Slot slot = task.slot(mix_, s);
    if (is_bsdf(slot.strategy) || is_line(slot.strategy)) continue;
    const bool visible = wants_region(slot.strategy) && task.view.region() != nullptr;
    const Sight sight = visible ? Sight::kNoOpaque : Sight::kUnknown;
    for (const int turn : task.turns)
      for (int i = 0; i < slot.count; ++i) {
        const Vec2d u = numbers(task, s, turn, i, sampler, depth);
        push(task, sample_point(slot.strategy, task.view, u), s, sight, kNoLine, 0);
      }
  }
}

void DirectLight::choose_lines(const Task& task, const PassSampler& sampler, int depth) {
  for (size_t s = 0; s < mix_.slots(); ++s) {
    const PreparedMix::Slot slot = task.slot(mix_, s);
    if (!is_line(slot.strategy)) continue;
    for (const int turn : task.turns)
      for (int i = 0; i < slot.count; ++i) {
        const Vec2d u = numbers(task, s, turn, i, sampler, depth);
        own_lines_.add(choose_line(slot.strategy, task.view, u.x), task.view.point(), task.view.emitter());
      }
  }
}

/// All lines of all line strategies first, traced in one call; then a point on each one's visible part.
void DirectLight::gather_lines(const Task& task, const PassSampler& sampler, int depth) {
  choose_lines(task, sampler, depth);
  if (own_lines_.size() == 0) return;
  own_lines_.trace(scene_.geometry, sight_.for_lines(), counters_);
  size_t line = 0;
  for (size_t s = 0; s < mix_.slots(); ++s) {
    const PreparedMix::Slot slot = task.slot(mix_, s);
    if (!is_line(slot.strategy)) continue;
    const bool integrates = this->integrates(slot.strategy);
    const bool samples = !integrates || !task.view.point().bsdf->only_lambertian();
    for (const int turn : task.turns)
      for (int i = 0; i < slot.count; ++i, ++line) {
        const std::span<const Interval> visible = own_lines_.visible(line);
        if (visible.empty()) continue;
        const LightLine& own = own_lines_.line(line);
        // Alone or in an average: every strategy of the mix has the same weight.
        if (integrates)
          integrated_ += closed_form(task.view, own, visible) / float(expected_[s] * double(mix_.slots()));
        if (!samples) continue;
        const Vec2d u = numbers(task, s, turn, i, sampler, depth);
        const LightPoint at = sample_line(own, task.view.x(), visible, u.y);
        const double on_line = parameter_of(own, at.p);
        push(task, task.view.is_area() ? towards(task.view, at) : towards_sky(task.view, own, on_line, at), s,
             Sight::kNoOpaque, line, on_line);
      }
  }
}

/// Lines know nothing of alpha-tested meshes, and their closed form nothing of what is lost on the way: where
/// there are such, points must answer for all of the light.
bool DirectLight::integrates(const Strategy& strategy) const {
  return is_analytic(strategy) && !scene_.geometry.has_alpha() && scene_.attenuation == nullptr;
}

void DirectLight::push(const Task& task, const LightSample& sample, size_t slot, Sight sight, size_t line,
                       double s) {
  if (!(sample.at.pdf > 0)) return;
  const ShadingPoint& point = task.view.point();
  const bool rest = integrates(task.slot(mix_, slot).strategy);
  const Rgb f =
      (rest ? point.scatter_beyond_lambertian(sample.wi) : point.scatter(sample.wi)) * sample.radiance;
  if (is_black(f)) return;
  // What bsdf meets is a hole to the ray itself.
  if (sight != Sight::kTraced && task.view.is_area() &&
      in_hole(scene_.geometry, task.view.area(), sample.at.p, point.time))
    return;
  candidates_.push_back({sample, f, slot, line, s, sight});
}

bool DirectLight::may_reach(const Task& task) {
  if (!task.view.is_area()) return true;
  VisibilityWork work;
  for (size_t s = 0; s < mix_.slots(); ++s) {
    const PreparedMix::Slot slot = task.slot(mix_, s);
    const int samples = slot.count * int(task.turns.size());
    if (is_line(slot.strategy))
      work.lines += samples;
    else if (!is_bsdf(slot.strategy))
      work.rays += samples;
    work.region |= wants_region(slot.strategy);
  }
  if (!scene_.lights.shafts && !work.region) return true;
  return sight_.look(scene_.geometry, task.view.point(), task.view.area(), task.light, work, counters_);
}

}  // namespace penumbra
