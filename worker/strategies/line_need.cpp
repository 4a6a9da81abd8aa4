#include "worker/strategies/line_need.h"

#include <algorithm>

namespace penumbra {

bool needs_line_hierarchy(const Mix& mix, const LightSet& lights) {
  if (mix.automatic) return true;  // there are lines among its candidates
  if (mix.lens == LensSampling::kLine || mix.medium == MediumSampling::kLine ||
      mix.motion == MotionSampling::kLine || mix.pixel == PixelSampling::kLine)
    return true;
  // Of a light that rays do not meet, bsdf asks with points (fit()).
  const bool invisible = std::any_of(lights.area.begin(), lights.area.end(),
                                     [](const AreaEmitter& light) { return light.invisible; });
  int points = 0;
  for (const StrategyCount& s : mix.strategies) {
    if (is_line(s.kind) || s.kind == StrategyKind::kVisibleArea) return true;
    if (s.kind != StrategyKind::kBsdf || invisible) points += s.count;
  }
  // Where lights are drawn, one may be drawn each time.
  return points * (lights.draws() ? LightSet::kMostAsked : 1) >= kLeastShaftRays;
}

}  // namespace penumbra
