#include <tuple>

#include "worker/geometry/shaft_walk.h"

namespace penumbra {

ShaftContent walk_shaft_avx512(const LineBvh& bvh, const Excluded& excluded, Shaft::Parts& shaft,
                               QueryCounters& counters) {
  return walk_shaft(bvh, excluded, shaft, counters);
}

void visible_in_list_avx512(const LineBvh& bvh, const ShaftList& list, std::span<const LineQuery> queries,
                            std::vector<IntervalSet>& out, QueryCounters& counters) {
  list_lines(bvh, list, queries, out, counters);
}

}  // namespace penumbra
