#include "worker/geometry/embree_geometry.h"

#include <cstring>

#include "proto/status.h"
#include "worker/geometry/tube.h"

namespace penumbra {
namespace {

/// Embree's filter: an alpha-tested hit that does not count is set aside and the ray goes on.
void alpha_filter(const RTCFilterFunctionNArguments* arguments) {
  PENUMBRA_CHECK(arguments->N == 1);
  const auto& alpha = *static_cast<const AlphaTest*>(arguments->geometryUserPtr);
  const auto* hit = reinterpret_cast<const RTCHit*>(arguments->hit);
  if (!alpha(hit->primID, hit->u, hit->v)) arguments->valid[0] = 0;
}

/// Embree's filter: what it meets of a tube counts if double precision meets it too. Single precision puts
/// the side of a segment of length L off by about u L²/r, which for the strand that a ray has just left is
/// more than its offset.
void tube_filter(const RTCFilterFunctionNArguments* arguments) {
  PENUMBRA_CHECK(arguments->N == 1);
  const auto& tubes = *static_cast<const Tubes*>(arguments->geometryUserPtr);
  const auto& ray = *reinterpret_cast<const RTCRay*>(arguments->ray);
  const auto* hit = reinterpret_cast<const RTCHit*>(arguments->hit);
  const Vec3d x(ray.org_x, ray.org_y, ray.org_z), d(ray.dir_x, ray.dir_y, ray.dir_z);
  // The ray's tfar is the hit's distance here, which is off by less than this.
  const Vec3d end = x + d * (ray.tfar * (1 + 0x1p-10));
  if (!meets(TubeSegment(&tubes.points[tubes.segments[hit->primID]]), x, end)) arguments->valid[0] = 0;
}

}  // namespace

GeometryHandle make_triangles(RTCDevice device, const TriangleMesh& mesh, const AlphaTest* alpha) {
  GeometryHandle geometry(rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE));
  // Copied, not shared: Embree reads 16 bytes at the last vertex, past the end of a foreign array.
  void* positions = rtcSetNewGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                            sizeof(Vec3f), mesh.positions.size());
  void* indices = rtcSetNewGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                          3 * sizeof(uint32_t), mesh.triangles());
  if (positions == nullptr || indices == nullptr) return nullptr;
  std::memcpy(positions, mesh.positions.data(), mesh.positions.size() * sizeof(Vec3f));
  std::memcpy(indices, mesh.indices.data(), mesh.indices.size() * sizeof(uint32_t));
  if (alpha != nullptr) {
    rtcSetGeometryUserData(geometry.get(), const_cast<AlphaTest*>(alpha));
    rtcSetGeometryIntersectFilterFunction(geometry.get(), alpha_filter);
    rtcSetGeometryOccludedFilterFunction(geometry.get(), alpha_filter);
  }
  rtcCommitGeometry(geometry.get());
  return geometry;
}

GeometryHandle make_tubes(RTCDevice device, const Tubes& tubes) {
  GeometryHandle geometry(rtcNewGeometry(device, RTC_GEOMETRY_TYPE_ROUND_LINEAR_CURVE));
  rtcSetSharedGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4,
                             tubes.points.data(), 0, sizeof(Imath::V4f), tubes.points.size());
  rtcSetSharedGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT, tubes.segments.data(),
                             0, sizeof(uint32_t), tubes.segments.size());
  auto* flags = static_cast<uint8_t*>(rtcSetNewGeometryBuffer(
      geometry.get(), RTC_BUFFER_TYPE_FLAGS, 0, RTC_FORMAT_UCHAR, sizeof(uint8_t), tubes.segments.size()));
  if (flags == nullptr) return nullptr;
  const std::vector<uint32_t>& first = tubes.segments;
  for (size_t i = 0; i < first.size(); ++i) {
    const bool left = i > 0 && first[i - 1] + 1 == first[i];
    const bool right = i + 1 < first.size() && first[i] + 1 == first[i + 1];
    flags[i] = static_cast<uint8_t>((left ? RTC_CURVE_FLAG_NEIGHBOR_LEFT : 0) |
                                    (right ? RTC_CURVE_FLAG_NEIGHBOR_RIGHT : 0));
  }
  rtcSetGeometryUserData(geometry.get(), const_cast<Tubes*>(&tubes));
  rtcSetGeometryIntersectFilterFunction(geometry.get(), tube_filter);
  rtcSetGeometryOccludedFilterFunction(geometry.get(), tube_filter);
  rtcCommitGeometry(geometry.get());
  return geometry;
}

GeometryHandle make_instance(RTCDevice device, RTCScene object, const Matrix& to_world) {
  GeometryHandle geometry(rtcNewGeometry(device, RTC_GEOMETRY_TYPE_INSTANCE));
  rtcSetGeometryInstancedScene(geometry.get(), object);
  // Rows of a row-vector matrix are Embree's columns.
  float columns[12];
  for (int row = 0; row < 4; ++row) {
    for (int k = 0; k < 3; ++k) columns[3 * row + k] = static_cast<float>(to_world[row][k]);
  }
  rtcSetGeometryTransform(geometry.get(), 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, columns);
  rtcCommitGeometry(geometry.get());
  return geometry;
}

}  // namespace penumbra
