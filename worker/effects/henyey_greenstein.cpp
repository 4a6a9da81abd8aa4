#include "worker/effects/henyey_greenstein.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "worker/sampling/warp.h"

namespace penumbra {

double phase(const HenyeyGreenstein& hg, const Vec3f& wo, const Vec3f& wi) {
  // 1 + g² + 2g cosθ with cosθ = wo·wi, from whichever peak the function has: no two terms cancel.
  const double g = hg.g;
  const Vec3d off = g < 0 ? Vec3d(wo) - Vec3d(wi) : Vec3d(wo) + Vec3d(wi);
  const double peak = 1 - std::abs(g), d = peak * peak + std::abs(g) * off.length2();
  return (1 - g) * (1 + g) / (4 * std::numbers::pi * d * std::sqrt(d));
}

Vec3f sample(const HenyeyGreenstein& hg, const Vec3f& wo, const Vec2d& u) {
  // The known inversion, cosθ = (1 + g² - q²) / 2g with q = (1 - g²)/(1 - g + 2gu) and θ the deflection,
  // written for 1 - cosθ and 1 + cosθ: factored, so that g cancels and g = 0 needs no case of its own.
  const double g = hg.g, d = (1 - g) + 2 * g * u.x;
  const double less = (1 - g) * (1 - g) * (1 - u.x) / d * ((1 + g) / d + 1);
  const double more = (1 + g) * (1 + g) * u.x / d * ((1 - g) / d + 1);
  const double cosine = less < more ? 1 - less : more - 1;
  const double sine = std::sqrt(std::max(0.0, less * more)), phi = 2 * std::numbers::pi * u.y;
  const Vec3d forwards(-wo);
  Vec3d s, t;
  frame(forwards, s, t);
  return Vec3f((s * (sine * std::cos(phi)) + t * (sine * std::sin(phi)) + forwards * cosine).normalized());
}

}  // namespace penumbra
