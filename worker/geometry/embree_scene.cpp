#include "worker/geometry/embree_scene.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "proto/status.h"
#include "worker/geometry/embree_geometry.h"
#include "worker/geometry/moving_instance.h"
#include "worker/geometry/near_light.h"

namespace penumbra {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

SceneHandle make_scene(RTCDevice device) {
  SceneHandle scene(rtcNewScene(device));
  rtcSetSceneFlags(scene.get(), RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION);
  rtcSetSceneBuildQuality(scene.get(), RTC_BUILD_QUALITY_HIGH);
  return scene;
}

/// Geometry numbers of a top scene: meshes first, then instances.
struct Scenes {
  std::vector<std::unique_ptr<MovingInstance>> moving;  // Embree keeps the addresses
  std::vector<SceneHandle> objects;
  SceneHandle top;
};

}  // namespace

struct EmbreeScene::Parts {
  DeviceHandle device;
  std::vector<std::unique_ptr<AlphaTest>> alphas;  // per mesh, null: opaque; Embree keeps the addresses
  Scenes all, alpha_only;
  Surfaces surfaces;
  uint32_t meshes = 0;
  bool has_alpha = false;

  /// Scenes of the meshes that have a handle.
  Scenes assemble(const std::vector<GeometryHandle>& handles, std::span<const ObjectInput> objects,
                  std::span<const InstanceInput> instances) const;
  /// Null for an object that moves and is empty.
  GeometryHandle place(const InstanceInput& instance, Scenes& scenes) const;
};

GeometryHandle EmbreeScene::Parts::place(const InstanceInput& instance, Scenes& scenes) const {
  const RTCScene object = scenes.objects[instance.object].get();
  if (!instance.motion) return make_instance(device.get(), object, instance.to_world);
  RTCBounds bounds;
  rtcGetSceneBounds(object, &bounds);
  if (!(bounds.lower_x <= bounds.upper_x)) return nullptr;
  MovingInstance& moving = *scenes.moving.emplace_back(new MovingInstance{object, instance.motion, {}});
  return make_moving_instance(device.get(), moving);
}

Scenes EmbreeScene::Parts::assemble(const std::vector<GeometryHandle>& handles,
                                    std::span<const ObjectInput> objects,
                                    std::span<const InstanceInput> instances) const {
  Scenes scenes;
  std::vector<bool> in_object(handles.size(), false);
  for (const ObjectInput& object : objects) {
    SceneHandle scene = make_scene(device.get());
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
    const GeometryHandle instance = place(instances[i], scenes);
    if (instance) rtcAttachGeometryByID(scenes.top.get(), instance.get(), meshes + i);
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
  parts.device = make_device(threads);
  if (!parts.device) return absl::InternalError("Embree gives no device");
  parts.meshes = static_cast<uint32_t>(meshes.size());
  for (const MeshInput& mesh : meshes) parts.surfaces.meshes.push_back(mesh.mesh);
  parts.surfaces.instances.assign(instances.begin(), instances.end());

  parts.alphas.resize(meshes.size());
  std::vector<GeometryHandle> opaque_and_alpha(meshes.size());
  std::vector<bool> tested(meshes.size(), false);
  for (size_t m = 0; m < meshes.size(); ++m) {
    if (!meshes[m].visible) continue;
    const AlphaTest* alpha = nullptr;
    if (meshes[m].alpha) {
      parts.alphas[m] = std::make_unique<AlphaTest>(meshes[m].alpha);
      alpha = parts.alphas[m].get();
      tested[m] = parts.has_alpha = true;
    }
    if (meshes[m].tubes != nullptr) {
      parts.surfaces.tubes.resize(meshes.size());
      parts.surfaces.tubes[m] = meshes[m].tubes;
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
  Vec3f lo, hi;
  scene->bounds(lo, hi);
  if (lo.x <= hi.x) parts.surfaces.extent = (hi.x - lo.x) + (hi.y - lo.y) + (hi.z - lo.z);
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
  query.ray.time = ray.time, query.ray.mask = ~0u, query.ray.id = 0, query.ray.flags = 0;
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
  hit.time = ray.time;
  if (parts_->surfaces.is_tube(hit.id)) refine(parts_->surfaces.segment(hit.id), ray, hit);
  return hit;
}

bool EmbreeScene::occluded(const Vec3f& x, const Vec3f& y, float time) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  return ray_hits(parts_->all.top.get(), context, x, y - x, 1, time);
}

bool EmbreeScene::occluded(const Vec3f& x, const LightEnd& y) const {
  return approach_hits(parts_->all.top.get(), parts_->surfaces, x, y);
}

bool EmbreeScene::occluded_by_alpha(const Vec3f& x, const Vec3f& y, float time) const {
  if (!parts_->has_alpha) return false;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  return ray_hits(parts_->alpha_only.top.get(), context, x, y - x, 1, time);
}

bool EmbreeScene::occluded_by_alpha(const Vec3f& x, const LightEnd& y) const {
  return parts_->has_alpha && approach_hits(parts_->alpha_only.top.get(), parts_->surfaces, x, y);
}

void EmbreeScene::beside(const Ray& ray, const Hit& first, const std::vector<bool>& marked,
                         std::vector<Meeting>& out) const {
  collect_beside(parts_->all.top.get(), parts_->surfaces, ray, first, marked, out);
}

bool EmbreeScene::has_alpha() const {
  return parts_->has_alpha;
}

bool EmbreeScene::in_hole(const PrimitiveId& first, uint32_t primitives, const Vec3d& p, float time) const {
  const AlphaTest* alpha = parts_->alphas[first.mesh].get();
  if (alpha == nullptr) return false;
  const Place place = place_on(parts_->surfaces, first, primitives, p, time);
  return !(*alpha)(place.primitive, float(place.u), float(place.v));
}

Imath::Box3f EmbreeScene::bounds(const PrimitiveId& first, uint32_t primitives) const {
  Imath::Box3f box;
  for (uint32_t i = 0; i < primitives; ++i)
    for (int c = 0; c < 3; ++c) box.extendBy(parts_->surfaces.vertex(first.mesh, first.primitive + i, c));
  return box;
}

bool EmbreeScene::anything_meets(const Imath::Box3d& box, const PrimitiveId& own, uint32_t primitives,
                                 const LightPlane& plane) const {
  for (const auto& moving : parts_->all.moving)
    for (size_t i = 1; i < moving->boxes.size(); ++i) {
      // Between two times it is between the two boxes.
      Imath::Box3d both(moving->boxes[i - 1].lo, moving->boxes[i - 1].hi);
      both.extendBy(Imath::Box3d(moving->boxes[i].lo, moving->boxes[i].hi));
      if (box.intersects(both)) return true;
    }
  return anything_stands_in(parts_->all.top.get(), parts_->surfaces, box, own, primitives, plane);
}

void EmbreeScene::bounds(Vec3f& lo, Vec3f& hi) const {
  RTCBounds b;
  rtcGetSceneBounds(parts_->all.top.get(), &b);
  lo = {b.lower_x, b.lower_y, b.lower_z};
  hi = {b.upper_x, b.upper_y, b.upper_z};
}

}  // namespace penumbra
