#include "worker/geometry/crossings.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>

#include "proto/status.h"

namespace penumbra {
namespace {

/// What Embree hands to the filter: first its own context, then where the crossings go.
struct Collecting {
  RTCIntersectContext context;
  std::vector<Crossing>* out;
};

/// Notes each hit and lets the ray go on.
void collect(const RTCFilterFunctionNArguments* arguments) {
  PENUMBRA_CHECK(arguments->N == 1);
  const auto* ray = reinterpret_cast<const RTCRay*>(arguments->ray);
  const auto* hit = reinterpret_cast<const RTCHit*>(arguments->hit);
  const Vec3f normal(hit->Ng_x, hit->Ng_y, hit->Ng_z), direction(ray->dir_x, ray->dir_y, ray->dir_z);
  auto* collecting = reinterpret_cast<Collecting*>(arguments->context);
  const float along = normal.dot(direction),
              cosine = std::abs(along) / (normal.length() * direction.length());
  collecting->out->push_back({ray->tfar, hit->geomID, cosine, along < 0});
  arguments->valid[0] = 0;
}

}  // namespace

struct CrossingScene::Parts {
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  ~Parts() {
    if (scene != nullptr) rtcReleaseScene(scene);
    if (device != nullptr) rtcReleaseDevice(device);
  }
};

CrossingScene::CrossingScene() : parts_(std::make_unique<Parts>()) {}
CrossingScene::CrossingScene(CrossingScene&&) noexcept = default;
CrossingScene& CrossingScene::operator=(CrossingScene&&) noexcept = default;
CrossingScene::~CrossingScene() = default;

absl::StatusOr<CrossingScene> CrossingScene::build(std::span<const TriangleMesh> meshes, int threads) {
  CrossingScene crossing;
  Parts& parts = *crossing.parts_;
  parts.device = rtcNewDevice(("threads=" + std::to_string(threads)).c_str());
  if (parts.device == nullptr) return absl::InternalError("Embree gives no device");
  parts.scene = rtcNewScene(parts.device);
  rtcSetSceneFlags(parts.scene, RTC_SCENE_FLAG_ROBUST);
  for (uint32_t m = 0; m < meshes.size(); ++m) {
    const TriangleMesh& mesh = meshes[m];
    RTCGeometry geometry = rtcNewGeometry(parts.device, RTC_GEOMETRY_TYPE_TRIANGLE);
    void* positions = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                              sizeof(Vec3f), mesh.positions.size());
    void* indices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                            3 * sizeof(uint32_t), mesh.triangles());
    if (positions != nullptr && indices != nullptr) {
      std::memcpy(positions, mesh.positions.data(), mesh.positions.size() * sizeof(Vec3f));
      std::memcpy(indices, mesh.indices.data(), mesh.indices.size() * sizeof(uint32_t));
      rtcSetGeometryIntersectFilterFunction(geometry, collect);
      rtcCommitGeometry(geometry);
      rtcAttachGeometryByID(parts.scene, geometry, m);
    }
    rtcReleaseGeometry(geometry);
  }
  rtcCommitScene(parts.scene);
  if (const RTCError error = rtcGetDeviceError(parts.device); error != RTC_ERROR_NONE)
    return make_status(absl::StatusCode::kResourceExhausted, "Embree error {} while building",
                       static_cast<int>(error));
  return crossing;
}

void CrossingScene::crossings(const Ray& ray, std::vector<Crossing>& out) const {
  out.clear();
  Collecting collecting;
  rtcInitIntersectContext(&collecting.context);
  collecting.out = &out;
  RTCRayHit query;
  query.ray.org_x = ray.origin.x, query.ray.org_y = ray.origin.y, query.ray.org_z = ray.origin.z;
  query.ray.dir_x = ray.direction.x, query.ray.dir_y = ray.direction.y, query.ray.dir_z = ray.direction.z;
  query.ray.tnear = std::max(std::nextafter(ray.near, std::numeric_limits<float>::infinity()),
                             std::numeric_limits<float>::min());
  query.ray.tfar = ray.far;
  query.ray.time = 0, query.ray.mask = ~0u, query.ray.id = 0, query.ray.flags = 0;
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(parts_->scene, &collecting.context, &query);
  std::sort(out.begin(), out.end(),
            [](const Crossing& a, const Crossing& b) { return a.distance < b.distance; });
}

}  // namespace penumbra
