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

/// The light's plane as a query's fan wants it: its chord's ends are rounded, too.
LightPlane chord_plane(const LineQuery& query);
/// The same plane in the coordinates of an object, `a` and `b` being the chord's ends relative to x there
/// (oa) and here: distances along the normal stay what they are.
LightPlane placed_plane(const LightPlane& plane, const Vec3d& a, const Vec3d& b, const Matrix& to_object);

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
