#pragma once
// Integrator "pointline" of Salesin & Jarosz's published code, as a mix of ours.
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "proto/mix.h"
#include "scenes/description.h"

namespace penumbra {

/// The mix that the scene's Integrator "pointline" asks for:
///   strategy1..3: brdf -> bsdf, pt-surf-area -> area, pt-solid-angle -> sa,
///     line-surf-area with angle a -> line-area@DEG, DEG = 180a + 90 mod 180 (they give the axis along
///       which lines are offset, we the lines' direction),
///     line-solid-angle with angle 0 -> line-sa@u, 1 -> line-sa@v;
///   mis false -> /average; smoothstep w > 0 -> /smooth=w, else /balance.
///   Counts: the N = xsamples × ysamples of the first AreaLightSource are shared out: all to a single
///   strategy; one each if N = 1; equally if "stratified"; else by "ratio" r: of two strategies
///   floor(r N) to the first and the rest to the second, of three ceil(r N) to each of the first two.
///   A strategy that gets none is left out.
/// InvalidArgument (`file:line:column: …`) for an unknown strategy or an angle out of range. What cannot
/// be taken literally is taken in the nearest way and said in `notes`.
absl::StatusOr<Mix> pointline_mix(const SceneDescription& scene, std::vector<std::string>& notes);

}  // namespace penumbra
