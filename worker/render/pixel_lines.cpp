#include "worker/render/pixel_lines.h"

#include "worker/effects/looks.h"

namespace penumbra {

void looks_across_pixel(const Camera& camera, const Filter& filter, const Vec2d& centre,
                        const PassSampler& sampler, const Geometry& geometry, QueryCounters& counters,
                        std::vector<FilterSample>& out) {
  thread_local std::vector<SeenInterval> seen;
  thread_local std::vector<Look> looks;
  // Half of the lines are rows, half columns: no direction of what they cross is left out.
  const int along = sampler.along_lens(0, 1) < 0.5 ? 0 : 1, across = 1 - along;
  const Vec2d u = sampler.film();
  FilterSample line;
  line.offset[across] = filter.sample_along(across, u.x, line.weight);
  const double radius = filter.radius()[along];
  Vec2d a = centre + line.offset, b = a;
  a[along] = centre[along] - radius;
  b[along] = centre[along] + radius;
  const Vec3d& pinhole = camera.pinhole();
  geometry.nearest(FocusedChord{pinhole - camera.towards(a), pinhole - camera.towards(b), pinhole, 0, true},
                   seen, counters);
  // From lengths of the film to the filter's measure, in which looks are spread.
  for (SeenInterval& interval : seen) {
    interval.lo = filter.place_of(along, (2 * interval.lo - 1) * radius);
    interval.hi = filter.place_of(along, (2 * interval.hi - 1) * radius);
  }
  seen.front().lo = 0;
  seen.back().hi = 1;
  looks_along(seen, u.y, looks);
  out.clear();
  for (const Look& look : looks) {
    FilterSample& there = out.emplace_back(line);
    there.offset[along] = filter.sample_along(along, look.at, there.weight);
    there.weight *= look.weight;
  }
}

}  // namespace penumbra
