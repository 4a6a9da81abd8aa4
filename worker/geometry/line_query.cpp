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

LightPlane chord_plane(const LineQuery& query) {
  const Vec3d& n = query.plane.normal;
  const double chord = std::max(rounding_along(n, Vec3d(query.a)), rounding_along(n, Vec3d(query.b)));
  return {n, query.plane.rounding + chord};
}

LightPlane placed_plane(const LightPlane& plane, const Vec3d& a, const Vec3d& b, const Matrix& to_object) {
  const Vec3d along = b - a, across = plane.normal.cross(along);
  Vec3d placed_a, placed_along, placed_across;
  to_object.multDirMatrix(a, placed_a);
  to_object.multDirMatrix(along, placed_along);
  to_object.multDirMatrix(across, placed_across);
  const Vec3d normal = placed_along.cross(placed_across);
  const double height = plane.normal.dot(a), placed_height = normal.dot(placed_a);
  if (placed_height == 0) return {};
  return {normal * (height / placed_height), plane.rounding};
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
