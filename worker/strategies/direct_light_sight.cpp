// What becomes of candidates: every strategy's density at each, and whether light comes from there.
#include <limits>

#include "worker/strategies/direct_light.h"
#include "worker/strategies/light_hit.h"
#include "worker/strategies/smoothing.h"

namespace penumbra {

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

bool DirectLight::clear(const Task& task, const LightSample& sample) {
  const Vec3f& origin = task.view.point().origin(sample.wi);
  const float time = task.view.point().time;
  if (!task.view.is_area())
    return !scene_.geometry.occluded(origin, origin + sample.wi * task.view.reach(), counters_, time);
  if (const VisibleRegion* region = task.view.region(); region != nullptr && !region->holds(sample.at.p))
    return false;
  if (task.view.area().flat) {
    const LightEnd end = end_on_light(task.view.area(), sample.at.p, sample.at.n, time);
    if (task.view.region() != nullptr) return !scene_.geometry.occluded_by_alpha(origin, end, counters_);
    const Shaft* shaft = sight_.for_rays(origin);
    return !(shaft != nullptr ? scene_.geometry.occluded(*shaft, origin, end, counters_)
                              : scene_.geometry.occluded(origin, end, counters_));
  }
  if (task.view.area().invisible)  // there is nothing that a ray could meet
    return !behind_own_wall(task.view.area().shape, sample.at.p, Vec3d(origin)) &&
           !scene_.geometry.occluded(origin, Vec3f(sample.at.p), counters_, time);
  // A curved light is traced as a tessellation that the sampled point is not on: it is visible if the
  // light is the first thing met, on the side that emits. The wall of one that emits inwards is in its way.
  const Ray ray{origin, sample.wi, 0, std::numeric_limits<float>::infinity(), time};
  const auto hit = scene_.geometry.intersect(ray, counters_);
  if (!hit) return false;
  const Vec3d p = Vec3d(origin) + Vec3d(sample.wi) * double(hit->distance);
  return scene_.lights.emitter_at(hit->id, p, sample.wi, time) == task.light;
}

}  // namespace penumbra
