#include "worker/strategies/light_hit.h"

namespace penumbra {
namespace {

/// Is p in the box, or nearer to it than a ray of that length may be off?
bool near_box(const Imath::Box3d& box, const Vec3d& p, double distance) {
  for (int k = 0; k < 3; ++k)
    if (p[k] < box.min[k] - distance || p[k] > box.max[k] + distance) return false;
  return true;
}

/// Of several surfaces that the ray may have met first: the light among them that nothing hides.
std::optional<LightHit> unhidden(const Geometry& geometry, const LightSet& lights, const Ray& ray,
                                 const Hit& first, QueryCounters& counters) {
  thread_local std::vector<Meeting> met;
  geometry.beside(ray, first, lights.crowded, met, counters);
  for (const Meeting& m : met) {
    const uint32_t emitter = lights.emitter_at(m.id, m.p, ray.direction, ray.time);
    if (emitter == kNone || !lights.area[emitter].crowded) continue;
    const AreaEmitter& light = lights.area[emitter];
    const LightEnd end = end_on_light(light, m.p, emission_normal(light.shape, m.p), ray.time);
    if (!geometry.occluded(ray.origin, end, counters)) return LightHit{emitter, m.p};
  }
  return std::nullopt;
}

}  // namespace

LightEnd end_on_light(const AreaEmitter& light, const Vec3d& p, const Vec3d& normal, float time) {
  const PrimitiveId id{light.instance, light.mesh, light.first_primitive};
  return {p, {normal, light.rounding}, id, light.primitives, light.crowded, time};
}

bool in_hole(const Geometry& geometry, const AreaEmitter& light, const Vec3d& p, float time) {
  if (!light.has_holes) return false;
  return geometry.in_hole({light.instance, light.mesh, light.first_primitive}, light.primitives, p, time);
}

std::optional<LightHit> light_met(const Geometry& geometry, const LightSet& lights, const Ray& ray,
                                  const Hit& first, QueryCounters& counters) {
  const Vec3d p = Vec3d(ray.origin) + Vec3d(ray.direction) * double(first.distance);
  // A ray's distance is never in doubt by more than half of it.
  if (!lights.crowded.empty() && near_box(lights.crowded_bounds, p, first.distance / 2)) {
    const auto found = unhidden(geometry, lights, ray, first, counters);
    if (found) return found;
  }
  const uint32_t emitter = lights.emitter_at(first.id, p, ray.direction, ray.time);
  if (emitter == kNone) return std::nullopt;
  // A crowded flat light was judged above, but for one that moves: of that the ray's distances are trusted.
  const AreaEmitter& light = lights.area[emitter];
  if (light.flat && light.crowded && !light.motion) return std::nullopt;
  return LightHit{emitter, p};
}

}  // namespace penumbra
