// DirectLight's answer to «when»: the samples of a light once more, sorted by the lengths of their paths.
#include "worker/strategies/direct_light.h"

namespace penumbra {

/// Points go where their lengths say. A line has something in every bin that its visible part touches (after
/// Marco et al. 2019: along a chord the length of the path is known): each bin gets a point of its own on its
/// part of the line, which counts by that part's share in the visible measure. With one bin for everything
/// that point is the one that the picture has.
void DirectLight::arrive(const Task& task, const PassSampler& sampler, int depth) {
  if (!task.view.is_area()) return;  // from infinitely far away nothing ever arrives
  Arrivals& arrivals = *scene_.arrivals;
  shares_.assign(candidates_.size(), 1);
  for (size_t c = 0; c < candidates_.size(); ++c)
    if (candidates_[c].line == kNoLine) arrive(task, c);
  candidates_.clear();
  shares_.clear();
  bins_.clear();
  size_t line = 0;
  for (size_t s = 0; own_lines_.size() > 0 && s < mix_.slots(); ++s) {
    const PreparedMix::Slot slot = task.slot(mix_, s);
    if (!is_line(slot.strategy)) continue;
    for (const int turn : task.turns)
      for (int i = 0; i < slot.count; ++i, ++line) {
        if (own_lines_.visible(line).empty()) continue;
        arrivals.cut(own_lines_.line(line), task.view.x(), own_lines_.visible(line), parts_);
        spread(task, s, line, numbers(task, s, turn, i, sampler, depth).y);
      }
  }
  if (candidates_.empty()) return;
  resolve(task);
  if (scene_.attenuation != nullptr) attenuate(task);
  for (size_t c = 0; c < candidates_.size(); ++c) arrive(task, c);
}

/// A point in every bin of parts_, which are of one line; what has a closed form needs none.
void DirectLight::spread(const Task& task, size_t slot, size_t line, double v) {
  const LightLine& own = own_lines_.line(line);
  const Strategy& strategy = task.slot(mix_, slot).strategy;
  const bool integrates = this->integrates(strategy);
  const bool samples = !integrates || !task.view.point().bsdf->only_lambertian();
  const double whole = own_lines_.visible_measure(line);
  for (size_t first = 0, last = 0; first < parts_.size(); first = last) {
    double measure = 0;
    for (; last < parts_.size() && parts_[last].bin == parts_[first].bin; ++last)
      measure += relative_measure(own, parts_[last].lo, parts_[last].hi);
    const std::span<const LinePart> parts(&parts_[first], last - first);
    if (integrates) {
      Rgb light(0);
      for (const LinePart& part : parts) light += closed_form(task.view, own, part.lo, part.hi);
      scene_.arrivals->add_to(parts[0].bin, light / float(expected_[slot] * double(mix_.slots())));
    }
    if (!samples || !(measure > 0)) continue;
    const double s = sample_parts(own, parts, measure, v);
    const LightPoint at{own.corner + (own.from + s * own.along), own.n,
                        pdf_line(own, task.view.x(), s, whole)};
    push(task, towards(task.view, at), slot, Sight::kNoOpaque, line, s);
    bins_.resize(candidates_.size(), parts[0].bin);
    shares_.resize(candidates_.size(), measure / whole);
  }
}

/// A weighed candidate: to the bin of its part of a line, or of its distance.
void DirectLight::arrive(const Task& task, size_t candidate) {
  const Candidate& c = candidates_[candidate];
  if (c.f == Rgb(0)) return;
  const Rgb light = c.f * float(combiner_.scale(found(candidate, c.slot)) * shares_[candidate]);
  if (c.line != kNoLine)
    scene_.arrivals->add_to(bins_[candidate], light);
  else
    scene_.arrivals->add((c.sample.at.p - task.view.x()).length(), light);
}

}  // namespace penumbra
