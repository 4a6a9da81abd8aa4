#pragma once
// Times line queries against shadow rays: one thread, thread-CPU clock, the two interleaved chunk by chunk,
// medians over repetitions.
#include "tests/bench/geometry/line_workload.h"

namespace penumbra::bench {

/// Chords by how much of them x sees.
enum Class { kAll, kVisible, kPartial, kOccluded, kClasses };
const char* name_of(Class c);

struct ClassTiming {
  size_t queries = 0;
  double ray_ns = 0, line_ns = 0;
  double ratio() const { return line_ns / ray_ns; }
  double nodes = 0, triangles = 0;  ///< visited per line
};

struct LineTiming {
  ClassTiming single[kClasses];
  double shared_ray_ns = 0;   ///< a shadow ray in the shared workload
  double shared_line_ns = 0;  ///< a line at one shading point with 4 lines and 4 points
  double shared_ratio() const { return shared_line_ns / shared_ray_ns; }
};

LineTiming time_lines(const Geometry& geometry, const BenchScene& scene, size_t queries, int repetitions);

}  // namespace penumbra::bench
