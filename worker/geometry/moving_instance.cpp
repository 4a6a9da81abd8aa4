#include "worker/geometry/moving_instance.h"

#include <cmath>
#include <limits>

#include "proto/status.h"
#include "worker/geometry/pose.h"

namespace penumbra {
namespace {

const MovingInstance& instance_of(void* user) {
  return *static_cast<const MovingInstance*>(user);
}

void set_bounds(const RTCBoundsFunctionArguments* arguments) {
  const MovedBox& box = instance_of(arguments->geometryUserPtr).boxes[arguments->timeStep];
  // Rounded outwards, and by as much again as Embree's interpolation between two steps may round.
  constexpr double kRounding = 4 * double{std::numeric_limits<float>::epsilon()};
  const auto lower = [](double x) { return static_cast<float>(x - kRounding * std::abs(x)); };
  const auto upper = [](double x) { return static_cast<float>(x + kRounding * std::abs(x)); };
  RTCBounds& out = *arguments->bounds_o;
  out.lower_x = lower(box.lo.x), out.lower_y = lower(box.lo.y), out.lower_z = lower(box.lo.z);
  out.upper_x = upper(box.hi.x), out.upper_y = upper(box.hi.y), out.upper_z = upper(box.hi.z);
}

/// Affine maps keep a ray's parameter: distances are the same in both spaces.
void carry_into_object(const MovingInstance& instance, RTCRay& ray) {
  const Matrix& to_object = pose_at(*instance.motion, ray.time).to_object;
  Vec3d origin, direction;
  to_object.multVecMatrix(Vec3d(ray.org_x, ray.org_y, ray.org_z), origin);
  to_object.multDirMatrix(Vec3d(ray.dir_x, ray.dir_y, ray.dir_z), direction);
  const Vec3f o(origin), d(direction);
  ray.org_x = o.x, ray.org_y = o.y, ray.org_z = o.z;
  ray.dir_x = d.x, ray.dir_y = d.y, ray.dir_z = d.z;
}

void intersect(const RTCIntersectFunctionNArguments* arguments) {
  PENUMBRA_CHECK(arguments->N == 1);
  if (arguments->valid[0] == 0) return;
  const MovingInstance& instance = instance_of(arguments->geometryUserPtr);
  auto& query = *reinterpret_cast<RTCRayHit*>(arguments->rayhit);
  RTCRayHit inside = query;
  inside.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  carry_into_object(instance, inside.ray);
  arguments->context->instID[0] = arguments->geomID;
  rtcIntersect1(instance.object, arguments->context, &inside);
  arguments->context->instID[0] = RTC_INVALID_GEOMETRY_ID;
  if (inside.hit.geomID == RTC_INVALID_GEOMETRY_ID) return;
  query.hit = inside.hit;
  query.ray.tfar = inside.ray.tfar;
}

void occluded(const RTCOccludedFunctionNArguments* arguments) {
  PENUMBRA_CHECK(arguments->N == 1);
  if (arguments->valid[0] == 0) return;
  const MovingInstance& instance = instance_of(arguments->geometryUserPtr);
  auto& ray = *reinterpret_cast<RTCRay*>(arguments->ray);
  RTCRay inside = ray;
  carry_into_object(instance, inside);
  arguments->context->instID[0] = arguments->geomID;
  rtcOccluded1(instance.object, arguments->context, &inside);
  arguments->context->instID[0] = RTC_INVALID_GEOMETRY_ID;
  if (inside.tfar < 0) ray.tfar = -std::numeric_limits<float>::infinity();
}

}  // namespace

GeometryHandle make_moving_instance(RTCDevice device, MovingInstance& instance) {
  RTCBounds b;
  rtcGetSceneBounds(instance.object, &b);
  instance.boxes = instance.motion->boxes(
      {Vec3d(b.lower_x, b.lower_y, b.lower_z), Vec3d(b.upper_x, b.upper_y, b.upper_z)});
  GeometryHandle handle(rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER));
  const RTCGeometry geometry = handle.get();
  rtcSetGeometryUserPrimitiveCount(geometry, 1);
  rtcSetGeometryTimeStepCount(geometry, static_cast<unsigned>(instance.boxes.size()));
  rtcSetGeometryUserData(geometry, &instance);
  rtcSetGeometryBoundsFunction(geometry, set_bounds, nullptr);
  rtcSetGeometryIntersectFunction(geometry, intersect);
  rtcSetGeometryOccludedFunction(geometry, occluded);
  rtcCommitGeometry(geometry);
  return handle;
}

}  // namespace penumbra
