#include "worker/geometry/crossings.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "proto/status.h"
#include "worker/geometry/embree_geometry.h"

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
  DeviceHandle device;
  SceneHandle scene;
};

CrossingScene::CrossingScene() : parts_(std::make_unique<Parts>()) {}
CrossingScene::CrossingScene(CrossingScene&&) noexcept = default;
CrossingScene& CrossingScene::operator=(CrossingScene&&) noexcept = default;
CrossingScene::~CrossingScene() = default;

absl::StatusOr<CrossingScene> CrossingScene::build(std::span<const TriangleMesh> meshes, int threads) {
  CrossingScene crossing;
  Parts& parts = *crossing.parts_;
  parts.device = make_device(threads);
  if (!parts.device) return absl::InternalError("Embree gives no device");
  parts.scene.reset(rtcNewScene(parts.device.get()));
  rtcSetSceneFlags(parts.scene.get(), RTC_SCENE_FLAG_ROBUST);
  for (uint32_t m = 0; m < meshes.size(); ++m) {
    const GeometryHandle geometry = make_triangles(parts.device.get(), meshes[m], nullptr);
    if (!geometry) continue;  // the device says so below
    rtcSetGeometryIntersectFilterFunction(geometry.get(), collect);
    rtcCommitGeometry(geometry.get());
    rtcAttachGeometryByID(parts.scene.get(), geometry.get(), m);
  }
  rtcCommitScene(parts.scene.get());
  if (const RTCError error = rtcGetDeviceError(parts.device.get()); error != RTC_ERROR_NONE)
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
  rtcIntersect1(parts_->scene.get(), &collecting.context, &query);
  std::sort(out.begin(), out.end(),
            [](const Crossing& a, const Crossing& b) { return a.distance < b.distance; });
}

}  // namespace penumbra
