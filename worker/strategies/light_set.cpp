#include "worker/strategies/light_set.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "worker/lights/moving_light.h"

namespace penumbra {

void LightSet::finish(float reach, const Vec3f& centre) {
  reach_ = reach;
  centre_ = centre;
  crowded.clear();
  crowded_bounds.makeEmpty();
  for (const AreaEmitter& light : area) {
    if (!light.flat || !light.crowded || light.motion) continue;
    crowded.resize(by_mesh.size());
    crowded[light.mesh] = true;
    const LightBounds bounds = bounds_of(light);
    crowded_bounds.extendBy(bounds.lo);
    crowded_bounds.extendBy(bounds.hi);
  }
  near_.clear();
  far_.clear();
  place_.assign(size(), 0);
  if (!draws()) return;
  std::vector<LightBounds> bounds;
  const auto place = [&](const LightBounds& b, size_t light) {
    place_[light] = uint32_t(near_.size());
    near_.push_back(uint32_t(light));
    bounds.push_back(b);
  };
  for (size_t l = 0; l < area.size(); ++l)
    place(area[l].motion ? bounds_of_moving(area[l]) : bounds_of(area[l]), l);
  for (size_t l = area.size(); l < size(); ++l) {
    const size_t d = l - area.size() - environments.size();
    if (is_far(l))
      far_.push_back(uint32_t(l));
    else if (const auto* point = std::get_if<PointEmitter>(&delta[d]))
      place(bounds_of(*point), l);
    else
      place(bounds_of(std::get<SpotEmitter>(delta[d])), l);
  }
  tree_ = LightTree(bounds);
}

float LightSet::reach_from(const Vec3f& x) const {
  const double far = (Vec3d(x) - Vec3d(centre_)).length() + double{reach_};
  return std::nextafter(float(far), std::numeric_limits<float>::infinity());
}

bool LightSet::is_far(size_t light) const {
  if (light < area.size()) return false;
  if (light < area.size() + environments.size()) return true;
  return std::holds_alternative<DistantEmitter>(delta[light - area.size() - environments.size()]);
}

double LightSet::far_irradiance(size_t light, const Receiver& receiver) const {
  if (light < area.size() + environments.size())
    return environments[light - area.size()].irradiance(receiver.x);
  const auto& distant = std::get<DistantEmitter>(delta[light - area.size() - environments.size()]);
  const double cosine = receiver.has_horizon ? receiver.normal.dot(Vec3d(distant.towards_light)) : 1;
  return luminance(distant.irradiance) * std::max(cosine, 0.0);
}

double LightSet::far_irradiance(const Receiver& receiver) const {
  double sum = 0;
  for (const uint32_t l : far_) sum += far_irradiance(l, receiver);
  return sum;
}

double LightSet::share_of_far(double far, const Receiver& receiver) const {
  const double near = tree_.importance(receiver);
  if (!(far > 0)) return 0;
  if (!(near > 0)) return 1;
  // What the tree says of all its lights together may be wrong by far, most of all amidst them: half of the
  // share is by the estimates, half is even.
  return 0.25 + 0.5 * far / (far + near);
}

DrawnLight LightSet::draw(const Receiver& receiver, double u) const {
  constexpr double kBelowOne = 1 - 0x1p-53;
  const double far = far_irradiance(receiver), share = share_of_far(far, receiver);
  if (!(u < share)) {
    DrawnLight drawn = tree_.draw(receiver, std::min((u - share) / (1 - share), kBelowOne));
    if (drawn.probability > 0) drawn.light = near_[drawn.light];
    drawn.probability *= 1 - share;
    return drawn;
  }
  double rest = u / share * far;
  DrawnLight drawn;
  for (const uint32_t l : far_) {
    const double irradiance = far_irradiance(l, receiver);
    if (!(irradiance > 0)) continue;
    drawn = {l, share * irradiance / far};
    if (rest < irradiance) break;
    rest -= irradiance;
  }
  return drawn;
}

double LightSet::probability(const Receiver& receiver, size_t light) const {
  const double far = far_irradiance(receiver), share = share_of_far(far, receiver);
  if (is_far(light)) return far > 0 ? share * far_irradiance(light, receiver) / far : 0;
  return (1 - share) * tree_.probability(receiver, place_[light]);
}

uint32_t LightSet::emitter_at(const PrimitiveId& hit, const Vec3d& p, const Vec3f& direction,
                              float time) const {
  if (hit.mesh >= by_mesh.size()) return kNone;
  const MeshLights& lights = by_mesh[hit.mesh];
  if (lights.first == kNone || hit.instance != lights.instance) return kNone;
  const uint32_t sides = lights.two_sided ? 2 : 1;
  const uint32_t front = lights.first + (lights.per_primitive ? hit.primitive * sides : 0);
  for (uint32_t e = front; e < front + sides; ++e) {
    const Vec3d normal = area[e].motion ? emission_normal(standing_at(area[e], double{time}).shape, p)
                                        : emission_normal(area[e].shape, p);
    if (normal.dot(Vec3d(direction)) < 0) return e;
  }
  return kNone;
}

}  // namespace penumbra
