#include "worker/strategies/direct_light.h"

#include <cmath>
#include <limits>

#include "worker/strategies/light_hit.h"
#include "worker/strategies/smoothing.h"

namespace penumbra {
namespace {

/// Streams of random numbers that belong to no single light.
constexpr uint32_t kBsdfStream = 0xffffffff, kDrawStream = 0x80000000;

bool is_black(const Rgb& c) {
  return c.x == 0 && c.y == 0 && c.z == 0;
}

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
    sum += ask({view, l, 1, kOnce, 1, uint32_t(l)}, sampler, depth);
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
      sum += ask({view, first.light, draws, turns_, kDraws, kDrawStream}, sampler, depth);
    } else {
      sum += delta(point, lights.delta[first.light - extended], float(double(turns_.size()) / draws));
    }
  }
  while (!hits_.empty()) {
    const size_t l = hits_.back().light;
    const LightView view = view_of(point, l);
    sum += ask({view, l, kDraws * lights.probability(receiver, l)}, sampler, depth);
  }
  return sum;
}

LightView DirectLight::view_of(const ShadingPoint& point, size_t light) const {
  const LightSet& lights = scene_.lights;
  if (light < lights.area.size()) return LightView(point, lights.area[light], &sight_);
  return LightView(point, lights.environments[light - lights.area.size()], lights.reach());
}

/// Traces the directions of the mix's bsdf samples once, for all lights, and keeps those that met one.
void DirectLight::trace_bsdf(const ShadingPoint& point, const PassSampler& sampler, int depth) {
  hits_.clear();
  const LightSet& lights = scene_.lights;
  for (size_t s = 0; s < mix_.slots(); ++s) {
    const PreparedMix::Slot slot = mix_.environment_slot(s);
    if (!is_bsdf(slot.strategy)) continue;
    for (int i = 0; i < slot.count; ++i) {
      const Vec2d u = sampler.light(depth, kBsdfStream, int(s), i, slot.count);
      const auto scattered =
          point.scattering.sample(point.wo, u, sampler.choice(depth, kBsdfStream, int(s), i, slot.count));
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
          found.sample.radiance = lights.environments[e].radiance(wi);
          found.sample.at = {Vec3d(point.above) + Vec3d(wi) * double(lights.reach()), Vec3d(0),
                             scattered->pdf};
          hits_.push_back(found);
        }
        continue;
      }
      const auto met = light_met(scene_.geometry, lights, ray, *hit, counters_);
      if (!met) continue;
      const AreaEmitter& light = lights.area[met->emitter];
      found.light = met->emitter;
      found.sample.radiance = light.radiance;
      found.sample.at = {met->p, emission_normal(light.shape, met->p), scattered->pdf};
      hits_.push_back(found);
    }
  }
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
  candidates_.push_back({sample, f, slot, line, s, sight});
}

void DirectLight::resolve(const Task& task) {
  const size_t slots = mix_.slots();
  const Combination how = mix_.combination();
  // These weigh with what lines can see from here; a line query per foreign candidate is the price.
  const bool queries =
      how == Combination::kBalance || how == Combination::kPower || how == Combination::kSmooth;
  foreign_lines_.clear();
  foreign_.assign(candidates_.size() * slots, kNoLine);
  if (queries) {
    for (size_t c = 0; c < candidates_.size(); ++c)
      for (size_t s = 0; s < slots; ++s) {
        const Strategy& strategy = task.slot(mix_, s).strategy;
        if (!is_line(strategy) || s == candidates_[c].slot) continue;
        foreign_[c * slots + s] =
            foreign_lines_.add(line_through(strategy, task.view, candidates_[c].sample.at.p),
                               task.view.point(), task.view.emitter());
      }
    if (foreign_lines_.size() > 0) foreign_lines_.trace(scene_.geometry, sight_.for_lines(), counters_);
  }
  densities_.assign(candidates_.size() * slots, 0);
  for (size_t c = 0; c < candidates_.size(); ++c) densities(task, candidates_[c], &densities_[c * slots]);
}

/// The density of every strategy of the mix at a candidate; a candidate that is hidden loses its f.
void DirectLight::densities(const Task& task, Candidate& c, double* row) {
  const size_t slots = mix_.slots();
  const size_t* foreign = &foreign_[size_t(row - densities_.data())];
  const Vec3d x = task.view.x();
  const bool smooths = mix_.combination() == Combination::kSmooth && task.view.is_area();
  if (smooths) c.smoothing = border_factor(mix_.smoothing(), task.view.area().shape, c.sample.at.p);
  for (size_t s = 0; s < slots; ++s) {
    const Strategy& strategy = task.slot(mix_, s).strategy;
    if (s == c.slot) {
      if (smooths && c.line != kNoLine)
        c.smoothing *=
            line_factor(mix_.smoothing(), own_lines_.line(c.line), own_lines_.visible(c.line), c.s);
      // A line's own density on its visible part is larger than if nothing were hidden.
      if (mix_.combination() == Combination::kFree && c.line != kNoLine)
        c.visible = own_lines_.visible_measure(c.line);
      row[s] = c.sample.at.pdf * c.visible;
    } else if (!is_line(strategy)) {
      if (mix_.combination() != Combination::kAverage) row[s] = density_of(strategy, task.view, c.sample);
    } else if (foreign[s] != kNoLine) {
      const LightLine& line = foreign_lines_.line(foreign[s]);
      const double at = parameter_of(line, c.sample.at.p);
      const bool seen = foreign_lines_.sees(foreign[s], at);
      if (seen) row[s] = pdf_line(line, x, at, foreign_lines_.visible_measure(foreign[s]));
      if (smooths && line.scale > 0)
        c.smoothing *= line_factor(mix_.smoothing(), line, foreign_lines_.visible(foreign[s]), at);
      if (c.sight == Sight::kUnknown) {
        // The line through the point knows whether the point is visible: no shadow ray.
        c.sight = Sight::kNoOpaque;
        if (!seen) c.f = Rgb(0);
      }
    } else if (mix_.combination() == Combination::kFree) {
      const LightLine line = line_through(strategy, task.view, c.sample.at.p);
      row[s] = pdf_line(line, x, parameter_of(line, c.sample.at.p), 1);
    }
  }
  if (c.sight == Sight::kUnknown) {
    if (!clear(task, c.sample)) c.f = Rgb(0);
  } else if (c.sight == Sight::kNoOpaque && scene_.geometry.has_alpha() && !is_black(c.f)) {
    if (!task.view.is_area()) {
      if (!clear(task, c.sample)) c.f = Rgb(0);
      return;
    }
    const ShadingPoint& point = task.view.point();
    const LightEnd end = end_on_light(task.view.area(), c.sample.at.p, c.sample.at.n, point.time);
    if (scene_.geometry.occluded_by_alpha(point.origin(c.sample.wi), end, counters_)) c.f = Rgb(0);
  }
}

void DirectLight::attenuate(const Task& task) {
  const ShadingPoint& point = task.view.point();
  const Vec3d x = task.view.x();
  for (Candidate& c : candidates_) {
    if (is_black(c.f)) continue;
    const double distance =
        task.view.is_area() ? (c.sample.at.p - x).length() : std::numeric_limits<double>::infinity();
    c.f *= scene_.attenuation->transmittance(point.origin(c.sample.wi), c.sample.wi, distance);
  }
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

bool DirectLight::clear(const Task& task, const LightSample& sample) {
  const Vec3f& origin = task.view.point().origin(sample.wi);
  const float time = task.view.point().time;
  if (!task.view.is_area())
    return !scene_.geometry.occluded(origin, origin + sample.wi * scene_.lights.reach(), counters_, time);
  if (const VisibleRegion* region = task.view.region(); region != nullptr && !region->holds(sample.at.p))
    return false;
  if (task.view.area().flat) {
    const LightEnd end = end_on_light(task.view.area(), sample.at.p, sample.at.n, time);
    if (task.view.region() != nullptr) return !scene_.geometry.occluded_by_alpha(origin, end, counters_);
    const Shaft* shaft = sight_.for_rays(origin);
    return !(shaft != nullptr ? scene_.geometry.occluded(*shaft, origin, end, counters_)
                              : scene_.geometry.occluded(origin, end, counters_));
  }
  // A curved light is traced as a tessellation that the sampled point is not on: it is visible if the
  // light is the first thing met.
  const Ray ray{origin, sample.wi, 0, std::numeric_limits<float>::infinity(), time};
  const auto hit = scene_.geometry.intersect(ray, counters_);
  return hit && hit->id.instance == kNone && hit->id.mesh == task.view.area().mesh;
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
  const AreaEmitter& emitter = scene_.lights.area[area_emitter];
  const LightView view = view_of(point, area_emitter);
  const Task task{view, area_emitter, 1};
  const LightSample sample = towards(view, {on_light, emission_normal(emitter.shape, on_light), 0});
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
  const DeltaLight light = delta_light_at(emitter, point.above, scene_.lights.reach());
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
