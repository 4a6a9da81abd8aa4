#include "worker/geometry/near_light.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "worker/geometry/light_end.h"

namespace penumbra {
namespace {

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
  const Surfaces& all = *context.surfaces;
  const auto instance = placed ? hit.instID[0] - static_cast<uint32_t>(all.meshes.size()) : kNone;
  if (instance == end.light.instance && hit.geomID == end.light.mesh &&
      hit.primID - end.light.primitive < end.light_primitives) {
    arguments->valid[0] = 0;
    return;
  }
  const PrimitiveId id{instance, hit.geomID, hit.primID};
  if (all.is_tube(id)) {
    if (!meets(all.segment(id), Vec3d(ray.org_x, ray.org_y, ray.org_z), end.p)) arguments->valid[0] = 0;
    return;
  }
  Vec3d surface[3];
  all.triangle(id, end.time, surface);
  if (!context.approach.hides(surface)) arguments->valid[0] = 0;
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

}  // namespace

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

Place place_on(const Surfaces& surfaces, const PrimitiveId& first, uint32_t primitives, const Vec3d& p,
               float time) {
  Place best;
  double deepest = -std::numeric_limits<double>::infinity();
  for (uint32_t k = 0; k < primitives; ++k) {
    const PrimitiveId id{first.instance, first.mesh, first.primitive + k};
    Vec3d c[3];
    surfaces.triangle(id, time, c);
    const Vec3d e1 = c[1] - c[0], e2 = c[2] - c[0], from = p - c[0], n = e1.cross(e2);
    if (!(n.length2() > 0)) continue;
    const double u = from.cross(e2).dot(n) / n.length2(), v = e1.cross(from).dot(n) / n.length2();
    const double depth = std::min({u, v, 1 - u - v});
    if (!(depth > deepest)) continue;
    deepest = depth;
    best.primitive = id.primitive;
    best.u = std::clamp(u, 0., 1.);
    best.v = std::clamp(v, 0., 1 - best.u);
  }
  return best;
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

void collect_beside(RTCScene scene, const Surfaces& all, const Ray& ray, const Hit& first,
                    const std::vector<bool>& marked, std::vector<Meeting>& out) {
  out.clear();
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
  rtcOccluded1(scene, &context.embree, &query);
}

bool anything_stands_in(RTCScene scene, const Surfaces& surfaces, const Imath::Box3d& box,
                        const PrimitiveId& own, uint32_t primitives, const LightPlane& plane) {
  const Vec3d centre = box.center();
  Neighbours neighbours{&surfaces, box, own, primitives, plane};
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  RTCPointQuery query;
  query.x = static_cast<float>(centre.x), query.y = static_cast<float>(centre.y);
  query.z = static_cast<float>(centre.z), query.time = 0;
  // A sphere around the box, wherever single precision puts its centre.
  const double radius = box.size().length() / 2 + (Vec3d(query.x, query.y, query.z) - centre).length();
  query.radius = std::nextafter(static_cast<float>(radius), std::numeric_limits<float>::infinity());
  rtcPointQuery(scene, &query, &context, find_neighbour, &neighbours);
  return neighbours.found;
}

}  // namespace penumbra
