#pragma once
// Embree's rays close to a flat light, judged in double precision (light_plane.h, light_end.h): segments that
// end on it, what a ray may have met beside it, and whether anything is near it at all.
#include <Imath/ImathBox.h>

#include <vector>

#include "scenes/curve.h"
#include "worker/geometry/embree.h"
#include "worker/geometry/geometry.h"
#include "worker/geometry/pose.h"
#include "worker/geometry/tube.h"

namespace penumbra {

/// Anything in (0, far) of the ray from x along d that the context's filter, if it has one, lets pass?
bool ray_hits(RTCScene scene, RTCIntersectContext& context, const Vec3f& x, const Vec3f& d, float far,
              float time);

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

/// A place on a triangle of a mesh, as Hit has it.
struct Place {
  uint32_t primitive = 0;
  double u = 0, v = 0;
};

/// Where p lies on a light of `primitives` flat triangles from the given one on: on the one that it is
/// deepest inside of, to its edges if rounding leaves it outside.
Place place_on(const Surfaces& surfaces, const PrimitiveId& first, uint32_t primitives, const Vec3d& p,
               float time);

/// Anything before the light's point, seen from x?
bool approach_hits(RTCScene scene, const Surfaces& surfaces, const Vec3f& x, const LightEnd& y);

/// Geometry::beside().
void collect_beside(RTCScene scene, const Surfaces& surfaces, const Ray& ray, const Hit& first,
                    const std::vector<bool>& marked, std::vector<Meeting>& out);

/// EmbreeScene::anything_meets(), but for instances that move.
bool anything_stands_in(RTCScene scene, const Surfaces& surfaces, const Imath::Box3d& box,
                        const PrimitiveId& own, uint32_t primitives, const LightPlane& plane);

}  // namespace penumbra
