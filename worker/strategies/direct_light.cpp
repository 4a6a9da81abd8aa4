#include "worker/strategies/direct_light.h"

#include <limits>

#include "worker/strategies/light_hit.h"

namespace penumbra {
namespace {

/// Stream of random numbers for drawn lights: it belongs to no single one.
constexpr uint32_t kDrawStream = 0x80000000;

/// Samples that the mix expects of a slot at this light: the n_s of the balance heuristic.
double expected_count(const PreparedMix::Slot& slot, double draws) {
  return is_bsdf(slot.strategy) ? slot.count : slot.count * draws;
}

}  // namespace

Rgb DirectLight::estimate(const ShadingPoint& point, const PassSampler& sampler, int depth) {
  trace_bsdf(point, sampler, depth);
  const LightSet& lights = scene_.lights;
  if (lights.draws()) return draw_lights(point, sampler, depth);
  Rgb sum(0);
  constexpr int kOnce[] = {0};
  for (size_t l = 0; l < lights.area.size() + lights.environments.size(); ++l) {
    const LightView view = view_of(point, l);
    sum += ask({view, l, 1, kOnce, 1, uint32_t(l), now_.strategies(l, point.time)}, sampler, depth);
  }
  for (const DeltaEmitter& e : lights.delta) sum += delta(point, e, 1);
  return sum;
}

/// Many lights: some are drawn, and the chance of being drawn is part of every density. What the material's
/// own directions met counts once, whether that light was drawn or not.
Rgb DirectLight::draw_lights(const ShadingPoint& point, const PassSampler& sampler, int depth) {
  constexpr int kDraws = LightSet::kMostAsked;
  const LightSet& lights = scene_.lights;
  const size_t extended = lights.area.size() + lights.environments.size();
  const Receiver receiver{Vec3d(point.above), point.has_horizon(), Vec3d(point.normal)};
  Rgb sum(0);
  drawn_.clear();
  for (int d = 0; d < kDraws; ++d) drawn_.push_back(lights.draw(receiver, sampler.draw(depth, d, kDraws)));
  for (size_t d = 0; d < drawn_.size(); ++d) {
    const DrawnLight first = drawn_[d];
    if (!(first.probability > 0)) continue;
    // All turns of one light together: its lines and what it looks like from here are made once.
    turns_.clear();
    for (size_t e = d; e < drawn_.size(); ++e) {
      if (!(drawn_[e].probability > 0) || drawn_[e].light != first.light) continue;
      turns_.push_back(int(e));
      drawn_[e].probability = 0;
    }
    const double draws = kDraws * first.probability;
    if (first.light < extended) {
      const LightView view = view_of(point, first.light);
      sum += ask(
          {view, first.light, draws, turns_, kDraws, kDrawStream, now_.strategies(first.light, point.time)},
          sampler, depth);
    } else {
      sum += delta(point, lights.delta[first.light - extended], float(double(turns_.size()) / draws));
    }
  }
  while (!hits_.empty()) {
    const size_t l = hits_.back().light;
    const LightView view = view_of(point, l);
    Task task{view, l, kDraws * lights.probability(receiver, l)};
    task.strategies = now_.strategies(l, point.time);
    sum += ask(task, sampler, depth);
  }
  return sum;
}

float DirectLight::reach(const ShadingPoint& point) const {
  return point.bsdf != nullptr ? scene_.lights.reach() : scene_.lights.reach_from(point.above);
}

LightView DirectLight::view_of(const ShadingPoint& point, size_t light) {
  const LightSet& lights = scene_.lights;
  if (light < lights.area.size()) return LightView(point, now_.at(light, point.time), &sight_);
  return LightView(point, lights.environments[light - lights.area.size()], reach(point));
}

Rgb DirectLight::ask(const Task& task, const PassSampler& sampler, int depth) {
  const Rgb sum = answer(task, sampler, depth);
  if (scene_.arrivals != nullptr) arrive(task, sampler, depth);
  return sum;
}

Rgb DirectLight::answer(const Task& task, const PassSampler& sampler, int depth) {
  candidates_.clear();
  own_lines_.clear();
  integrated_ = Rgb(0);
  sight_.skip();
  start_combiner(task);
  // With drawn lights the material's hits are asked on their own, once.
  if (task.turns.empty() || !scene_.lights.draws()) gather_bsdf(task);
  if (candidates_.empty() && task.turns.empty()) return integrated_;
  if (may_reach(task)) {
    gather_points(task, sampler, depth);
    gather_lines(task, sampler, depth);
  }
  if (candidates_.empty()) return integrated_;
  resolve(task);
  if (scene_.attenuation != nullptr) attenuate(task);
  return integrated_ + combine();
}

void DirectLight::start_combiner(const Task& task) {
  expected_.clear();
  line_slots_.clear();
  for (size_t s = 0; s < mix_.slots(); ++s) {
    const PreparedMix::Slot slot = task.slot(mix_, s);
    expected_.push_back(expected_count(slot, task.draws));
    line_slots_.push_back(is_line(slot.strategy));
  }
  combiner_.start(mix_.combination(), expected_, line_slots_);
}

Found DirectLight::found(size_t candidate, size_t slot) const {
  const Candidate& c = candidates_[candidate];
  const std::span<const double> row(&densities_[candidate * mix_.slots()], mix_.slots());
  return {slot, slot == c.slot ? c.sample.at.pdf : row[slot], c.visible, c.smoothing, row};
}

/// Estimator of one light: Σ over candidates of weight × f / (n p), with n p of the strategy that found
/// it. Veach & Guibas 1995; design §6.
Rgb DirectLight::combine() {
  Rgb sum(0);
  for (size_t c = 0; c < candidates_.size(); ++c) {
    const Candidate& candidate = candidates_[c];
    if (!is_black(candidate.f)) sum += candidate.f * float(combiner_.scale(found(c, candidate.slot)));
  }
  return sum;
}

DirectLight::Integrand DirectLight::integrand(const ShadingPoint& point, size_t area_emitter,
                                              const Vec3d& on_light) {
  const LightView view = view_of(point, area_emitter);
  Task task{view, area_emitter, 1};
  task.strategies = now_.strategies(area_emitter, point.time);
  LightSample sample = towards(view, {on_light, emission_normal(view.area().shape, on_light), 0});
  if (in_hole(scene_.geometry, view.area(), on_light, point.time)) sample.radiance = Rgb(0);
  candidates_.assign(1, {sample, point.scatter(sample.wi) * sample.radiance, mix_.slots(), kNoLine});
  own_lines_.clear();
  sight_.skip();
  may_reach(task);
  resolve(task);
  start_combiner(task);
  Integrand out{candidates_[0].f, candidates_[0].smoothing, densities_, {}};
  for (size_t s = 0; s < mix_.slots(); ++s) out.weights.push_back(combiner_.weight(found(0, s)));
  return out;
}

Rgb DirectLight::delta(const ShadingPoint& point, const DeltaEmitter& emitter, float weight) {
  const DeltaLight light = delta_light_at(emitter, point.above, reach(point));
  if (is_black(light.irradiance)) return Rgb(0);
  Rgb f = point.scatter(light.wi) * light.irradiance;
  if (is_black(f) || scene_.geometry.occluded(point.origin(light.wi), light.end, counters_, point.time))
    return Rgb(0);
  const double distance = std::holds_alternative<DistantEmitter>(emitter)
                              ? std::numeric_limits<double>::infinity()
                              : double((light.end - point.above).length());
  if (scene_.attenuation != nullptr)
    f *= scene_.attenuation->transmittance(point.origin(light.wi), light.wi, distance);
  f *= weight;
  if (scene_.arrivals != nullptr) scene_.arrivals->add(distance, f);
  return f;
}

}  // namespace penumbra
