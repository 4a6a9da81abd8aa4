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

/// Visible parts of chords that share x, by the given path. `out` is resized to queries.size().
void visible_lines(const LineBvh& bvh, LinePath path, std::span<const LineQuery> queries,
                   std::vector<IntervalSet>& out, QueryCounters& counters);

// The paths; `out` has the right size already. Scalar is the reference: query after query, triangle after
// triangle.
void visible_scalar(const LineBvh& bvh, std::span<const LineQuery> queries, std::vector<IntervalSet>& out,
                    QueryCounters& counters);
void visible_avx2(const LineBvh& bvh, std::span<const LineQuery> queries, std::vector<IntervalSet>& out,
                  QueryCounters& counters);
void visible_avx512(const LineBvh& bvh, std::span<const LineQuery> queries, std::vector<IntervalSet>& out,
                    QueryCounters& counters);

}  // namespace penumbra
