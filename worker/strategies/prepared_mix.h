#pragma once
// A mix made ready for a scene's lights: what each of its strategies is on each of them.
#include <vector>

#include "proto/mix.h"
#include "worker/strategies/light_set.h"
#include "worker/strategies/smoothing.h"
#include "worker/strategies/strategy.h"

namespace penumbra {

class PreparedMix {
 public:
  /// `beside_area_lights`: the scene has some that are not among `lights`.
  PreparedMix(const Mix& mix, const LightSet& lights, bool beside_area_lights = false);

  struct Slot {
    const Strategy& strategy;
    int count;
  };
  size_t slots() const { return counts_.size(); }
  /// `light`: area emitters first, then environments. Of those that move: when the shutter opens.
  Slot slot(size_t light, size_t s) const { return {fitted_[light * slots() + s], counts_[s]}; }
  int count(size_t s) const { return counts_[s]; }
  /// Directions that the slot draws from the material, for all lights; 0: it is no bsdf slot.
  int directions(size_t s) const { return mix_.strategies[s].kind == StrategyKind::kBsdf ? counts_[s] : 0; }
  Combination combination() const { return combination_; }
  bool lines_in_media() const { return mix_.medium == MediumSampling::kLine; }
  /// Light samples of a shading point and light.
  int samples() const { return mix_.samples(); }
  /// The mix itself, to be prepared for other lights.
  const Mix& mix() const { return mix_; }
  const Smoothing& smoothing() const { return smoothing_; }

 private:
  std::vector<Strategy> fitted_;  ///< row per light
  std::vector<int> counts_;
  Combination combination_;
  Smoothing smoothing_;
  Mix mix_;
};

}  // namespace penumbra
