#include <tuple>

#include "worker/geometry/line_walk.h"

namespace penumbra {

void visible_avx512(const LineBvh& bvh, std::span<const LineQuery> queries, std::vector<IntervalSet>& out,
                    QueryCounters& counters) {
  visible_vector(bvh, queries, out, counters);
}

}  // namespace penumbra
