#include "worker/geometry/surface_point.h"

#include <limits>

namespace penumbra {

Vec3f SurfacePoint::offset(const Vec3f& towards) const {
  // The true point lies in the box p ± p_error; the plane through it is at most Σ|n_k| e_k away along
  // the normal (pbrt-v3 §3.9.5). Moving that far clears the surface; each coordinate is then rounded
  // away from it, so that the sum's own rounding cannot bring it back.
  const bool behind = ng.dot(towards) < 0;
  const float bound = std::abs(ng.x) * p_error.x + std::abs(ng.y) * p_error.y + std::abs(ng.z) * p_error.z;
  const float away = behind ? -1.f : 1.f, side = away * (bound + (behind ? back : front));
  constexpr float inf = std::numeric_limits<float>::infinity();
  Vec3f moved = p + side * ng;
  for (int k = 0; k < 3; ++k) {
    const float direction = away * ng[k];
    if (direction != 0) moved[k] = std::nextafter(moved[k], direction > 0 ? inf : -inf);
  }
  return moved;
}

}  // namespace penumbra
