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
  Slot slot(size_t area_emitter, size_t s) const { return {fitted_[area_emitter * slots() + s], counts_[s]}; }
  Slot environment_slot(size_t s) const { return {environment_[s], counts_[s]}; }
  Combination combination() const { return combination_; }
  bool lines_in_media() const { return mix_.medium == MediumSampling::kLine; }
  /// Light samples of a shading point and light.
  int samples() const { return mix_.samples(); }
  /// The mix itself, to be prepared for other lights.
  const Mix& mix() const { return mix_; }
  const Smoothing& smoothing() const { return smoothing_; }

 private:
  std::vector<Strategy> fitted_;  ///< row per area emitter
  std::vector<Strategy> environment_;
  std::vector<int> counts_;
  Combination combination_;
  Smoothing smoothing_;
  Mix mix_;

};

}  // namespace penumbra
