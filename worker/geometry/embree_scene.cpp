#include "worker/geometry/embree_scene.h"

#include <embree3/rtcore.h>

#include <cmath>
#include <cstring>
#include <algorithm>
#include <limits>
#include <string>

#include "proto/status.h"
#include "worker/geometry/tube.h"

namespace penumbra {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

struct DeviceDeleter {
  void operator()(RTCDeviceTy* device) const { rtcReleaseDevice(device); }
};
struct SceneDeleter {
  void operator()(RTCSceneTy* scene) const { rtcReleaseScene(scene); }
};
struct GeometryDeleter {
  void operator()(RTCGeometryTy* geometry) const { rtcReleaseGeometry(geometry); }
};
using Device = std::unique_ptr<RTCDeviceTy, DeviceDeleter>;
using Scene = std::unique_ptr<RTCSceneTy, SceneDeleter>;
using GeometryHandle = std::unique_ptr<RTCGeometryTy, GeometryDeleter>;

/// Embree's filter: an alpha-tested hit that does not count is set aside and the ray goes on.
void alpha_filter(const RTCFilterFunctionNArguments* arguments) {
  PENUMBRA_CHECK(arguments->N == 1);
  const auto& alpha = *static_cast<const AlphaTest*>(arguments->geometryUserPtr);
  const auto* hit = reinterpret_cast<const RTCHit*>(arguments->hit);
  if (!alpha(hit->primID, hit->u, hit->v)) arguments->valid[0] = 0;
}

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

/// Chains of cone-spheres; the inside of a chain is no surface.
GeometryHandle make_tubes(RTCDevice device, const Tubes& tubes) {
  GeometryHandle geometry(rtcNewGeometry(device, RTC_GEOMETRY_TYPE_ROUND_LINEAR_CURVE));
  rtcSetSharedGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, tubes.points.data(), 0,
                             sizeof(Imath::V4f), tubes.points.size());
  rtcSetSharedGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT, tubes.segments.data(), 0,
                             sizeof(uint32_t), tubes.segments.size());
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
  rtcCommitGeometry(geometry.get());
  return geometry;
}

Scene make_scene(RTCDevice device) {
  Scene scene(rtcNewScene(device));
  rtcSetSceneFlags(scene.get(), RTC_SCENE_FLAG_ROBUST);
  rtcSetSceneBuildQuality(scene.get(), RTC_BUILD_QUALITY_HIGH);
  return scene;
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

bool segment_hits(RTCScene scene, const Vec3f& x, const Vec3f& y) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  const Vec3f d = y - x;
  RTCRay ray;
  // Strictly beyond x: Embree's robust test counts a surface at the near end itself, and at x it would be
  // the one that x was moved off, by as little as a denormal number where its plane passes through 0.
  ray.org_x = x.x, ray.org_y = x.y, ray.org_z = x.z, ray.tnear = std::numeric_limits<float>::min();
  ray.dir_x = d.x, ray.dir_y = d.y, ray.dir_z = d.z, ray.time = 0;
  ray.tfar = std::nextafter(1.f, 0.f);
  ray.mask = ~0u, ray.id = 0, ray.flags = 0;
  rtcOccluded1(scene, &context, &ray);
  return ray.tfar < 0;  // Embree's sign of a hit: -inf
}

/// Geometry numbers of a top scene: meshes first, then instances.
struct Scenes {
  Scene top;
  std::vector<Scene> objects;
};

}  // namespace

struct EmbreeScene::Parts {
  Device device;
  std::vector<std::unique_ptr<AlphaTest>> alphas;  // Embree keeps the addresses
  Scenes all, alpha_only;
  uint32_t meshes = 0;
  bool has_alpha = false;
  std::vector<const Tubes*> tubes;  ///< per mesh; empty if there are none

  /// Scenes of the meshes that have a handle.
  Scenes assemble(const std::vector<GeometryHandle>& handles, std::span<const ObjectInput> objects,
                  std::span<const InstanceInput> instances) const;
};

Scenes EmbreeScene::Parts::assemble(const std::vector<GeometryHandle>& handles,
                                    std::span<const ObjectInput> objects,
                                    std::span<const InstanceInput> instances) const {
  Scenes scenes;
  std::vector<bool> in_object(handles.size(), false);
  for (const ObjectInput& object : objects) {
    Scene scene = make_scene(device.get());
    for (uint32_t m = object.first_mesh; m < object.last_mesh; ++m) {
      in_object[m] = true;
      if (handles[m]) rtcAttachGeometryByID(scene.get(), handles[m].get(), m);
    }
    rtcCommitScene(scene.get());
    scenes.objects.push_back(std::move(scene));
  }
  scenes.top = make_scene(device.get());
  for (uint32_t m = 0; m < handles.size(); ++m) {
    if (!in_object[m] && handles[m]) rtcAttachGeometryByID(scenes.top.get(), handles[m].get(), m);
  }
  for (uint32_t i = 0; i < instances.size(); ++i) {
    const GeometryHandle instance =
        make_instance(device.get(), scenes.objects[instances[i].object].get(), instances[i].to_world);
    rtcAttachGeometryByID(scenes.top.get(), instance.get(), meshes + i);
  }
  rtcCommitScene(scenes.top.get());
  return scenes;
}

EmbreeScene::EmbreeScene() : parts_(std::make_unique<Parts>()) {}
EmbreeScene::~EmbreeScene() = default;

absl::StatusOr<std::unique_ptr<EmbreeScene>> EmbreeScene::build(std::span<const MeshInput> meshes,
                                                                std::span<const ObjectInput> objects,
                                                                std::span<const InstanceInput> instances,
                                                                int threads) {
  std::unique_ptr<EmbreeScene> scene(new EmbreeScene);
  Parts& parts = *scene->parts_;
  parts.device.reset(rtcNewDevice(("threads=" + std::to_string(threads)).c_str()));
  if (!parts.device) return absl::InternalError("Embree gives no device");
  parts.meshes = static_cast<uint32_t>(meshes.size());

  std::vector<GeometryHandle> opaque_and_alpha(meshes.size());
  std::vector<bool> tested(meshes.size(), false);
  for (size_t m = 0; m < meshes.size(); ++m) {
    if (!meshes[m].visible) continue;
    const AlphaTest* alpha = nullptr;
    if (meshes[m].alpha) {
      alpha = parts.alphas.emplace_back(std::make_unique<AlphaTest>(meshes[m].alpha)).get();
      tested[m] = parts.has_alpha = true;
    }
    if (meshes[m].tubes != nullptr) {
      parts.tubes.resize(meshes.size());
      parts.tubes[m] = meshes[m].tubes;
      opaque_and_alpha[m] = make_tubes(parts.device.get(), *meshes[m].tubes);
    } else {
      opaque_and_alpha[m] = make_triangles(parts.device.get(), *meshes[m].mesh, alpha);
    }
    if (!opaque_and_alpha[m]) {
      return make_status(absl::StatusCode::kResourceExhausted, "no memory for a mesh of {} triangles",
                         meshes[m].mesh->triangles());
    }
  }
  parts.all = parts.assemble(opaque_and_alpha, objects, instances);
  if (parts.has_alpha) {
    for (size_t m = 0; m < meshes.size(); ++m) {
      if (!tested[m]) opaque_and_alpha[m].reset();
    }
    parts.alpha_only = parts.assemble(opaque_and_alpha, objects, instances);
  }
  if (const RTCError error = rtcGetDeviceError(parts.device.get()); error != RTC_ERROR_NONE) {
    return make_status(absl::StatusCode::kResourceExhausted, "Embree error {} while building",
                       static_cast<int>(error));
  }
  return scene;
}

std::optional<Hit> EmbreeScene::intersect(const Ray& ray) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRayHit query;
  query.ray.org_x = ray.origin.x, query.ray.org_y = ray.origin.y, query.ray.org_z = ray.origin.z;
  query.ray.dir_x = ray.direction.x, query.ray.dir_y = ray.direction.y, query.ray.dir_z = ray.direction.z;
  query.ray.tnear = std::max(std::nextafter(ray.near, kInfinity), std::numeric_limits<float>::min());
  query.ray.tfar = ray.far;
  query.ray.time = 0, query.ray.mask = ~0u, query.ray.id = 0, query.ray.flags = 0;
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(parts_->all.top.get(), &context, &query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
  const uint32_t instance = query.hit.instID[0];
  Hit hit;
  hit.id = {instance == RTC_INVALID_GEOMETRY_ID ? kNone : instance - parts_->meshes, query.hit.geomID,
            query.hit.primID};
  hit.distance = query.ray.tfar;
  hit.u = query.hit.u;
  hit.v = query.hit.v;
  if (!parts_->tubes.empty() && instance == RTC_INVALID_GEOMETRY_ID && parts_->tubes[hit.id.mesh] != nullptr) {
    const Tubes& tubes = *parts_->tubes[hit.id.mesh];
    refine(TubeSegment(&tubes.points[tubes.segments[hit.id.primitive]]), ray, hit);
  }
  return hit;
}

bool EmbreeScene::occluded(const Vec3f& x, const Vec3f& y) const {
  return segment_hits(parts_->all.top.get(), x, y);
}

bool EmbreeScene::occluded_by_alpha(const Vec3f& x, const Vec3f& y) const {
  return parts_->has_alpha && segment_hits(parts_->alpha_only.top.get(), x, y);
}

bool EmbreeScene::has_alpha() const {
  return parts_->has_alpha;
}

void EmbreeScene::bounds(Vec3f& lo, Vec3f& hi) const {
  RTCBounds b;
  rtcGetSceneBounds(parts_->all.top.get(), &b);
  lo = {b.lower_x, b.lower_y, b.lower_z};
  hi = {b.upper_x, b.upper_y, b.upper_z};
}

}  // namespace penumbra
