#pragma once
// What a second is worth here and now: a fixed piece of work, timed between slices of rendering on the same
// thread. CPU per pass divided by its time is what `gate` compares with a baseline from another day or
// another machine.
#include <limits>

#include "proto/job.h"

namespace penumbra {

/// One unit: dependent square roots, divisions and loads, as shading has them. Its table stays within the
/// first-level cache, so that what a renderer leaves in the caches hardly changes the time: a change that
/// wastes cache must show in its own figure and not in this one. The result is always the same number.
double calibration_unit();

/// Times units between slices, rarely enough to cost less than 1 % of the time.
class CalibrationClock {
 public:
  /// Adds a unit to `into` if it is time for one (always for the first call).
  void before_slice(Calibration& into);

 private:
  double last_ = -std::numeric_limits<double>::infinity();  ///< thread CPU seconds
};

}  // namespace penumbra
