#include "worker/geometry/embree_scene.h"

#include <Imath/ImathBox.h>
#include <embree3/rtcore.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>

#include "proto/status.h"
#include "worker/geometry/light_end.h"
#include "worker/geometry/moving_instance.h"
#include "worker/geometry/pose.h"
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

/// Chains of cone-spheres; the inside of a chain is no surface.
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

Scene make_scene(RTCDevice device) {
  Scene scene(rtcNewScene(device));
  rtcSetSceneFlags(scene.get(), RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION);
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

/// Anything in (0, far) of the ray from x along d that the context's filter, if it has one, lets pass?
bool ray_hits(RTCScene scene, RTCIntersectContext& context, const Vec3f& x, const Vec3f& d, float far,
              float time) {
  RTCRay ray;
  // Strictly beyond x: Embree's robust test counts a surface at the near end itself, and at x it would be
  // the one that x was moved off, by as little as a denormal number where its plane passes through 0.
  ray.org_x = x.x, ray.org_y = x.y, ray.org_z = x.z, ray.tnear = std::numeric_limits<float>::min();
  ray.dir_x = d.x, ray.dir_y = d.y, ray.dir_z = d.z, ray.time = time;
  ray.tfar = std::nextafter(far, 0.f);
  ray.mask = ~0u, ray.id = 0, ray.flags = 0;
  rtcOccluded1(scene, &context, &ray);
  return ray.tfar < 0;  // Embree's sign of a hit: -inf
}

/// The scene's own triangles, for the filter that judges hits close to a light.
struct Surfaces {
  std::vector<const TriangleMesh*> meshes;
  std::vector<const Tubes*> tubes;  ///< per mesh, null for triangles; empty if there are none
  std::vector<InstanceInput> instances;
  float extent = 0;  ///< Σ of the three extents of all of them

  const Vec3f& vertex(uint32_t mesh, uint32_t primitive, int corner) const {
    const TriangleMesh& m = *meshes[mesh];
    return m.positions[m.indices[3 * size_t{primitive} + static_cast<size_t>(corner)]];
  }
  bool is_tube(const PrimitiveId& id) const {
    return !tubes.empty() && id.instance == kNone && tubes[id.mesh] != nullptr;
  }
  TubeSegment segment(const PrimitiveId& id) const {
    return TubeSegment(&tubes[id.mesh]->points[tubes[id.mesh]->segments[id.primitive]]);
  }
  /// In the world, at a time.
  void triangle(const PrimitiveId& id, float time, Vec3d p[3]) const {
    for (int c = 0; c < 3; ++c) {
      p[c] = Vec3d(vertex(id.mesh, id.primitive, c));
      const Vec3d in_object = p[c];
      if (id.instance != kNone) to_world(instances[id.instance], time).multVecMatrix(in_object, p[c]);
    }
  }
  static const Matrix& to_world(const InstanceInput& instance, float time) {
    return instance.motion ? pose_at(*instance.motion, time).to_world : instance.to_world;
  }
};

/// Embree's context of a ray that collects what it meets of some meshes.
struct CollectContext {
  RTCIntersectContext embree;  // first: the filter is given its address
  const Surfaces* surfaces;
  const std::vector<bool>* marked;
  std::vector<Meeting>* out;
};

/// Embree's filter: notes a hit, and the ray goes on.
void collect_filter(const RTCFilterFunctionNArguments* arguments) {
  const auto& context = *reinterpret_cast<const CollectContext*>(arguments->context);
  const auto& hit = *reinterpret_cast<const RTCHit*>(arguments->hit);
  arguments->valid[0] = 0;
  if (hit.instID[0] != RTC_INVALID_GEOMETRY_ID || !(*context.marked)[hit.geomID]) return;
  Vec3d p[3];
  for (int c = 0; c < 3; ++c) p[c] = Vec3d(context.surfaces->vertex(hit.geomID, hit.primID, c));
  const double u = hit.u, v = hit.v;
  context.out->push_back({{kNone, hit.geomID, hit.primID}, p[0] * (1 - u - v) + p[1] * u + p[2] * v});
}

/// Embree's context of a segment that ends on a light, with what its filter needs.
struct ApproachContext {
  RTCIntersectContext embree;  // first: the filter is given its address
  const Surfaces* surfaces;
  const LightEnd* end;
  LightApproach approach;
};

/// Embree's filter: of what a ray meets close to a light only what is before it counts.
void approach_filter(const RTCFilterFunctionNArguments* arguments) {
  const auto& context = *reinterpret_cast<const ApproachContext*>(arguments->context);
  const auto& ray = *reinterpret_cast<const RTCRay*>(arguments->ray);
  const auto& hit = *reinterpret_cast<const RTCHit*>(arguments->hit);
  if (ray.tfar < LightApproach::kJudged) return;  // the ray's tfar is the hit's distance here
  const LightEnd& end = *context.end;
  const bool placed = hit.instID[0] != RTC_INVALID_GEOMETRY_ID;
  if (!placed && hit.geomID == end.light.mesh && hit.primID - end.light.primitive < end.light_primitives) {
    arguments->valid[0] = 0;
    return;
  }
  const Surfaces& all = *context.surfaces;
  const auto instance = placed ? hit.instID[0] - static_cast<uint32_t>(all.meshes.size()) : kNone;
  const PrimitiveId id{instance, hit.geomID, hit.primID};
  if (all.is_tube(id)) {
    if (!meets(all.segment(id), Vec3d(ray.org_x, ray.org_y, ray.org_z), end.p)) arguments->valid[0] = 0;
    return;
  }
  Vec3d surface[3];
  all.triangle(id, end.time, surface);
  if (!context.approach.hides(surface)) arguments->valid[0] = 0;
}

bool approach_hits(RTCScene scene, const Surfaces& surfaces, const Vec3f& x, const LightEnd& y) {
  ApproachContext context{{}, &surfaces, &y, LightApproach(x, y)};
  rtcInitIntersectContext(&context.embree);
  if (context.approach.alone())  // to just before the light, and no filter
    return ray_hits(scene, context.embree, x, context.approach.way(), context.approach.before(), y.time);
  context.embree.filter = approach_filter;
  return ray_hits(scene, context.embree, x, context.approach.way(), context.approach.beyond(surfaces.extent),
                  y.time);
}

/// What a query around a light looks for.
struct Neighbours {
  const Surfaces* surfaces;
  Imath::Box3d box;
  PrimitiveId own;
  uint32_t primitives;
  LightPlane plane;
  bool found = false;

  /// The rest of a flat mesh that emits: it hides nothing, and rays that end before the plane do not meet it.
  bool in_the_plane(const Vec3d p[3]) const {
    const Vec3d corner(surfaces->vertex(own.mesh, own.primitive, 0));
    for (int c = 0; c < 3; ++c)
      if (std::abs(plane.normal.dot(p[c] - corner)) > plane.rounding + rounding_along(plane.normal, p[c]))
        return false;
    return true;
  }
};

/// Embree's callback for each triangle whose bounds may meet the query's sphere.
bool find_neighbour(RTCPointQueryFunctionArguments* arguments) {
  auto& looking = *static_cast<Neighbours*>(arguments->userPtr);
  const bool placed = arguments->context->instStackSize != 0;
  const uint32_t mesh = arguments->geomID, primitive = arguments->primID;
  if (looking.found ||
      (!placed && mesh == looking.own.mesh && primitive - looking.own.primitive < looking.primitives))
    return false;
  const auto meshes = static_cast<uint32_t>(looking.surfaces->meshes.size());
  if (!placed && mesh >= meshes) return false;  // an instance that moves: its boxes are asked apart
  const PrimitiveId id{placed ? arguments->context->instID[0] - meshes : kNone, mesh, primitive};
  Imath::Box3d bounds;
  if (looking.surfaces->is_tube(id)) {
    const TubeSegment segment = looking.surfaces->segment(id);
    for (const double w : {0., 1.})
      for (const double side : {-1., 1.})
        bounds.extendBy(segment.centre(w) + Vec3d(side * segment.radius(w)));
  } else {
    Vec3d p[3];
    looking.surfaces->triangle(id, 0, p);
    if (!placed && mesh == looking.own.mesh && looking.in_the_plane(p)) return false;
    for (const Vec3d& corner : p) bounds.extendBy(corner);
  }
  if (!bounds.intersects(looking.box)) return false;
  looking.found = true;
  arguments->query->radius = 0;  // enough is known
  return true;
}

/// Geometry numbers of a top scene: meshes first, then instances.
struct Scenes {
  std::vector<std::unique_ptr<MovingInstance>> moving;  // Embree keeps the addresses
  std::vector<Scene> objects;
  Scene top;
};

}  // namespace

struct EmbreeScene::Parts {
  Device device;
  std::vector<std::unique_ptr<AlphaTest>> alphas;  // Embree keeps the addresses
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
  return GeometryHandle(make_moving_instance(device.get(), moving));
}

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
  parts.device.reset(rtcNewDevice(("threads=" + std::to_string(threads)).c_str()));
  if (!parts.device) return absl::InternalError("Embree gives no device");
  parts.meshes = static_cast<uint32_t>(meshes.size());
  for (const MeshInput& mesh : meshes) parts.surfaces.meshes.push_back(mesh.mesh);
  parts.surfaces.instances.assign(instances.begin(), instances.end());

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

void EmbreeScene::beside(const Ray& ray, const Hit& first, const std::vector<bool>& marked,
                         std::vector<Meeting>& out) const {
  out.clear();
  const Surfaces& all = parts_->surfaces;
  const Vec3d way = Vec3d(ray.direction) * double{first.distance};
  Vec3d n = way.normalized();  // a tube may lie along any plane: the least doubt will do
  if (!all.is_tube(first.id)) {
    Vec3d p[3];
    all.triangle(first.id, ray.time, p);
    n = (p[1] - p[0]).cross(p[2] - p[0]).normalized();
  }
  const Vec3d end = Vec3d(ray.origin) + way;
  const auto norm1 = [](const Vec3d& v) { return std::abs(v.x) + std::abs(v.y) + std::abs(v.z); };
  const float doubt = LightApproach::doubt(static_cast<float>(norm1(end) + norm1(way)) + all.extent,
                                           static_cast<float>(std::abs(n.dot(way))));
  CollectContext context{{}, &all, &marked, &out};
  rtcInitIntersectContext(&context.embree);
  context.embree.filter = collect_filter;
  RTCRay query;
  query.org_x = ray.origin.x, query.org_y = ray.origin.y, query.org_z = ray.origin.z;
  query.dir_x = ray.direction.x, query.dir_y = ray.direction.y, query.dir_z = ray.direction.z;
  query.tnear = first.distance * (1 - doubt), query.tfar = first.distance * (1 + doubt);
  query.time = ray.time, query.mask = ~0u, query.id = 0, query.flags = 0;
  rtcOccluded1(parts_->all.top.get(), &context.embree, &query);
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

bool EmbreeScene::has_alpha() const {
  return parts_->has_alpha;
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
  const Vec3d centre = box.center();
  Neighbours neighbours{&parts_->surfaces, box, own, primitives, plane};
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  RTCPointQuery query;
  query.x = static_cast<float>(centre.x), query.y = static_cast<float>(centre.y);
  query.z = static_cast<float>(centre.z), query.time = 0;
  // A sphere around the box, wherever single precision puts its centre.
  const double radius = box.size().length() / 2 + (Vec3d(query.x, query.y, query.z) - centre).length();
  query.radius = std::nextafter(static_cast<float>(radius), kInfinity);
  rtcPointQuery(parts_->all.top.get(), &query, &context, find_neighbour, &neighbours);
  return neighbours.found;
}

void EmbreeScene::bounds(Vec3f& lo, Vec3f& hi) const {
  RTCBounds b;
  rtcGetSceneBounds(parts_->all.top.get(), &b);
  lo = {b.lower_x, b.lower_y, b.lower_z};
  hi = {b.upper_x, b.upper_y, b.upper_z};
}

}  // namespace penumbra
