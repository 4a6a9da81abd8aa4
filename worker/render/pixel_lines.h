#pragma once
// `/pixel=line`: what a pixel covers, by lines across it (Barringer, Gribel & Akenine-Möller 2012,
// «High-quality curve rendering using line sampled visibility»). Along a line of the film what a pinhole sees
// is known from where to where, curves included; each stretch of one mesh is looked at by a ray of its own.
#include <vector>

#include "worker/render/camera.h"
#include "worker/render/filter.h"
#include "worker/sampling/sampler.h"

namespace penumbra {

/// Where to look in a pixel's filter about `centre`, with weights that the radiances are to be multiplied by
/// before they are added up: an estimate of the filtered radiance. A line is along one axis of the film, as
/// long as the filter is wide; where it crosses the other axis, and where on each stretch, is drawn by the
/// filter. Without bias, whatever the intervals are.
void looks_across_pixel(const Camera& camera, const Filter& filter, const Vec2d& centre,
                        const PassSampler& sampler, const Geometry& geometry, QueryCounters& counters,
                        std::vector<FilterSample>& out);

}  // namespace penumbra
