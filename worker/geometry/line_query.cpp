#include "worker/geometry/line_query.h"

namespace penumbra {

LinePath widest_line_path() {
  const bool avx512 = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
                      __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl");
  return avx512 ? LinePath::kAvx512 : LinePath::kAvx2;  // the whole program needs AVX2
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

void visible_lines(const LineBvh& bvh, LinePath path, std::span<const LineQuery> queries,
                   std::vector<IntervalSet>& out, QueryCounters& counters) {
  out.resize(queries.size());
  counters.line_queries += queries.size();
  switch (path) {
    case LinePath::kScalar:
      return visible_scalar(bvh, queries, out, counters);
    case LinePath::kAvx2:
      return visible_avx2(bvh, queries, out, counters);
    case LinePath::kAvx512:
      return visible_avx512(bvh, queries, out, counters);
  }
}

}  // namespace penumbra
