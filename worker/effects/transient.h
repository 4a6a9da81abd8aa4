#pragma once
// Transient light: a pixel's light sorted by the length of its path into the bins of --transient. Wanted only
// by jobs with JobSpec::transient.
#include <vector>

#include "proto/job.h"
#include "worker/lights/chord_distance.h"
#include "worker/strategies/arrivals.h"

namespace penumbra {

/// The bins of one camera sample.
class TimeBins final : public Arrivals {
 public:
  explicit TimeBins(const Transient& transient);

  void clear() {
    take([](int, const Vec3d&) {});
  }
  /// A camera ray begins, and counts so much in the pixel.
  void weigh(double weight) { weight_ = weight; }

  void stand_at(double length, const Rgb& throughput) override;
  void add(double distance, const Rgb& light) override;
  void add_to(int bin, const Rgb& light) override;
  void cut(const LightLine& line, const Vec3d& x, std::span<const Interval> visible,
           std::vector<LinePart>& out) const override;

  /// Hands each bin that has anything to `each(bin, value)`, and is empty again.
  template <class Each>
  void take(const Each& each) {
    for (const int bin : touched_) {
      each(bin, values_[size_t(bin)]);
      values_[size_t(bin)] = Vec3d(0);
      holds_[size_t(bin)] = false;
    }
    touched_.clear();
  }

 private:
  /// The bin of a path's length; -1 below all of them, their number above.
  int bin_of(double length) const;
  /// A part of a chord on which the distance only falls, or only grows.
  void cut_falling(const ChordDistance& chord, double lo, double hi, std::vector<LinePart>& out) const;
  void cut_growing(const ChordDistance& chord, double lo, double hi, std::vector<LinePart>& out) const;
  void put(int bin, double lo, double hi, std::vector<LinePart>& out) const;

  Transient transient_;
  double weight_ = 1, length_ = 0;
  Vec3d throughput_{1};
  std::vector<Vec3d> values_;
  std::vector<bool> holds_;
  std::vector<int> touched_;
};

}  // namespace penumbra
