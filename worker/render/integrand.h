#pragma once
// What a strategy's samples are worth over a light, drawn: `converge --integrand`.
#include <atomic>

#include "worker/render/renderer.h"

namespace penumbra {

/// Renders a task of a job with Probe::kIntegrand: pixel (i,j) of the frame is a point of one area light as
/// its `area` strategy maps the unit square onto it (for a quad o + u U + v V), its value w·f/p for the
/// strategy that the probe names: f BSDF × cosine × radiance × visibility, p that strategy's density (sr⁻¹),
/// w its weight in the mix. What the strategy's variance is made of: the flatter the picture, the less of it.
/// Black where the camera's pixel meets no surface that scatters, or the scene has no such light.
TaskOutcome render_integrand(const Scene& scene, const JobSpec& job, const TileTask& task,
                             const std::atomic<bool>& cancel);

}  // namespace penumbra
