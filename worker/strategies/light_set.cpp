#include "worker/strategies/light_set.h"

#include <algorithm>
#include <numbers>

namespace penumbra {
namespace {

constexpr double kPi = std::numbers::pi;

double luminance(const Rgb& c) { return 0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z; }

/// Emitted power as far as it matters for choosing; a light infinitely far away is spread over the
/// scene's cross-section (pbrt-v3 §12.5.1).
double power(const DeltaEmitter& emitter, float reach) {
  struct Power {
    double disk;
    double operator()(const PointEmitter& e) const { return 4 * kPi * luminance(e.intensity); }
    double operator()(const SpotEmitter& e) const {
      return 2 * kPi * (1 - 0.5 * (double(e.cos_inner) + e.cos_outer)) * luminance(e.intensity);
    }
    double operator()(const DistantEmitter& e) const { return disk * luminance(e.irradiance); }
  };
  return std::visit(Power{kPi * reach * reach / 4}, emitter);
}

}  // namespace

void LightSet::finish(float reach) {
  reach_ = reach;
  sums_.assign(1, 0);
  const auto push = [&](double watts) { sums_.push_back(sums_.back() + watts); };
  for (const AreaEmitter& e : area) push(kPi * penumbra::area(e.shape) * luminance(e.radiance));
  for (const Environment& e : environments) push(kPi * kPi * reach * reach / 4 * e.mean_luminance());
  for (const DeltaEmitter& e : delta) push(power(e, reach));
}

uint32_t LightSet::emitter_at(const PrimitiveId& hit, const Vec3d& p, const Vec3f& direction) const {
  if (hit.instance != kNone || hit.mesh >= by_mesh.size()) return kNone;
  const MeshLights& lights = by_mesh[hit.mesh];
  if (lights.first == kNone) return kNone;
  const uint32_t sides = lights.two_sided ? 2 : 1;
  const uint32_t front = lights.first + (lights.per_primitive ? hit.primitive * sides : 0);
  for (uint32_t e = front; e < front + sides; ++e)
    if (emission_normal(area[e].shape, p).dot(Vec3d(direction)) < 0) return e;
  return kNone;
}

size_t LightSet::draw(double u) const {
  const double target = u * sums_.back();
  const auto it = std::upper_bound(sums_.begin() + 1, sums_.end(), target);
  return std::min(size_t(it - sums_.begin()) - 1, size() - 1);
}

double LightSet::probability(size_t light) const {
  return (sums_[light + 1] - sums_[light]) / sums_.back();
}

}  // namespace penumbra
