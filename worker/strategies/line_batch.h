#pragma once
// The lines of one shading point towards one light, traced together: each clipped to what x can see of
// the light at all (front side, horizon), then to what nothing hides.
#include <span>
#include <vector>

#include "worker/geometry/shaft.h"
#include "worker/lights/emitter.h"
#include "worker/lights/line.h"
#include "worker/strategies/shading_point.h"

namespace penumbra {

class LineBatch {
 public:
  void clear();
  /// Puts a line into the batch and returns its handle. A line with scale 0 is allowed: nothing visible.
  /// `emitter`: whose line it is; null: of light from infinitely far away.
  size_t add(const LightLine& line, const ShadingPoint& point, const AreaEmitter* emitter);
  /// Asks for the visible part of everything added; `shaft`, if there is one, answers for what starts above
  /// the surface.
  void trace(const Geometry& geometry, const Shaft* shaft, QueryCounters& counters);
  void trace(const Geometry& geometry, QueryCounters& counters) { trace(geometry, nullptr, counters); }

  const LightLine& line(size_t handle) const { return lines_[handle].line; }
  /// Visible intervals of s in [0,1], ascending.
  std::span<const Interval> visible(size_t handle) const;
  /// Sum of relative_measure() over the visible intervals: 1 where nothing is hidden.
  double visible_measure(size_t handle) const { return lines_[handle].measure; }
  bool sees(size_t handle, double s) const;
  size_t size() const { return count_; }

 private:
  struct Line {
    LightLine line;
    size_t first = 0, last = 0;  ///< into intervals_
    double measure = 0;
  };
  /// A part of a line on one side of the horizon.
  struct Part {
    size_t line = 0;
    Interval range;  ///< of the line's s
  };
  struct Side {
    std::vector<LineQuery> queries;
    std::vector<Part> parts;
    std::vector<IntervalSet> visible;
    void clear() {
      queries.clear();
      parts.clear();
    }
  };

  void add_part(Side& side, size_t line, const Interval& range, const ShadingPoint& point, const Vec3f& x,
                const AreaEmitter* emitter);
  void gather(size_t line, const Side& side, size_t& next);

  std::vector<Line> lines_;  ///< grows only; count_ of them are in use
  size_t count_ = 0;
  Side above_, below_;
  std::vector<Interval> intervals_;
};

}  // namespace penumbra
