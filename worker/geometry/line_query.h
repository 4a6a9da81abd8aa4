#pragma once
// The walk of one line query through the hierarchy.
#include <vector>

#include "worker/geometry/line_bvh.h"

namespace penumbra {

/// How a line query is carried out; every path gives the same bits.
enum class LinePath { kScalar, kAvx2, kAvx512 };

/// The widest path this processor has.
LinePath widest_line_path();
const char* name_of(LinePath path);

/// Visible parts of chords that share x. The reference: one query after another, triangle by triangle.
void visible_scalar(const LineBvh& bvh, std::span<const LineQuery> queries, std::vector<IntervalSet>& out,
                    QueryCounters& counters);

/// The same by the given path.
void visible_lines(const LineBvh& bvh, LinePath path, std::span<const LineQuery> queries,
                   std::vector<IntervalSet>& out, QueryCounters& counters);

}  // namespace penumbra
