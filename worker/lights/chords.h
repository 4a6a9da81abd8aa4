#pragma once
// The chords of a flat light in one direction: what `line-area@DEG` chooses from. Any convex polygon.
#include <array>
#include <span>

#include "worker/lights/line.h"

namespace penumbra {

/// Made once per light and strategy; does not depend on x.
class ParallelChords {
 public:
  /// Direction at `radians` from the first edge towards the second, in the light's plane. A shape that is
  /// not flat and straight-edged has no chords (has_line_area).
  ParallelChords(const LightShape& shape, double radians);

  /// The chord at quantile u of the density p(s) = ℓ(s)/A over the offsets s across the direction.
  LightLine choose(double u) const;
  /// The chord through p.
  LightLine through(const Vec3d& p) const;
  /// The same with offsets uniform across the light: of density 1 / width, whatever the chord's length.
  LightLine choose_uniform(double u) const;
  LightLine through_uniform(const Vec3d& p) const;

 private:
  /// Of one offset: the chord's ends (minus the polygon's first corner) and its length.
  struct Cut {
    double offset = 0, length = 0;
    Vec3d a{0, 0, 0}, b{0, 0, 0};
  };
  /// A corner minus the first one, in the plane: r along the chords, s across them.
  struct Corner {
    Vec3d position{0, 0, 0};
    double r = 0, s = 0;
  };
  class Chain;
  void cut_at_corners(std::span<const Corner> corners);
  LightLine at_offset(double s) const;
  LightLine uniform(LightLine line) const;
  LightLine line_between(const Cut& below, const Cut& above, double fraction) const;

  // Cuts through the corners, by ascending offset; between two of them a chord's ends move linearly.
  static constexpr int kMostCorners = 4;
  std::array<Cut, kMostCorners> cuts_;
  std::array<double, kMostCorners> area_below_{};  ///< area of the polygon below each cut
  int count_ = 0;                                  ///< 0: no chords
  Vec3d corner_{0, 0, 0}, normal_{0, 0, 0},
      across_{0, 0, 0};  ///< across: unit, in the plane; offsets are measured along it
};

}  // namespace penumbra
