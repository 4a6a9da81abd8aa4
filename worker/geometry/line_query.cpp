#include "worker/geometry/line_query.h"

namespace penumbra {

LinePath widest_line_path() {
  return LinePath::kScalar;
}

const char* name_of(LinePath path) {
  switch (path) {
    case LinePath::kScalar:
      return "scalar";
    case LinePath::kAvx2:
      return "avx2";
    case LinePath::kAvx512:
      return "avx512";
  }
  return "";
}

void visible_lines(const LineBvh& bvh, LinePath, std::span<const LineQuery> queries,
                   std::vector<IntervalSet>& out, QueryCounters& counters) {
  visible_scalar(bvh, queries, out, counters);
}

}  // namespace penumbra
