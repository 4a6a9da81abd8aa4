#pragma once
// When light arrives: where every contribution of a path goes by the path's length. A stage of DirectLight
// and of the path tracer: null where nobody asks, and then one test of a pointer per light and path vertex.
#include <span>
#include <vector>

#include "scenes/math.h"
#include "worker/geometry/intervals.h"
#include "worker/lights/line.h"

namespace penumbra {

/// The part [lo,hi] of a line, in its s, from where light arrives in one bin.
struct LinePart {
  int bin = 0;
  double lo = 0, hi = 0;
};

/// Belongs to one thread. Lengths are distances in scene units, in media and glass as in vacuum.
class Arrivals {
 public:
  virtual ~Arrivals() = default;
  /// The path stands `length` from the camera; what is added from now on counts with `throughput`.
  virtual void stand_at(double length, const Rgb& throughput) = 0;
  /// Light from `distance` farther on; infinite: it never arrives.
  virtual void add(double distance, const Rgb& light) = 0;
  /// Light of a bin.
  virtual void add_to(int bin, const Rgb& light) = 0;
  /// The visible intervals of a line, seen from x, where the path stands, cut where bins end: by ascending
  /// bins, and in each by ascending s. What arrives in no bin is left out.
  virtual void cut(const LightLine& line, const Vec3d& x, std::span<const Interval> visible,
                   std::vector<LinePart>& out) const = 0;
};

}  // namespace penumbra
