#pragma once
// The light that a traced ray has met.
#include <optional>

#include "worker/geometry/geometry.h"
#include "worker/strategies/light_set.h"

namespace penumbra {

struct LightHit {
  uint32_t emitter = kNone;  ///< index into LightSet::area
  Vec3d p;                   ///< where it was met
};

/// Where a shadow segment to the point p of a flat light ends, at a time of the shutter.
LightEnd end_on_light(const AreaEmitter& light, const Vec3d& p, const Vec3d& normal, float time);

/// Is the point p of a light where that has a hole, so that no light comes from it?
bool in_hole(const Geometry& geometry, const AreaEmitter& light, const Vec3d& p, float time);

/// The area light that radiates along the ray, `first` being the nearest surface that the ray met. Where a
/// flat light is so close to other surfaces that the ray's distances do not say which is first, that is
/// decided as for shadow segments (LightEnd).
std::optional<LightHit> light_met(const Geometry& geometry, const LightSet& lights, const Ray& ray,
                                  const Hit& first, QueryCounters& counters);

}  // namespace penumbra
