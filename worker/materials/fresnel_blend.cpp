#include "worker/materials/fresnel_blend.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "worker/materials/local_frame.h"
#include "worker/sampling/warp.h"

namespace penumbra {
namespace {

double pow5(double x) {
  return (x * x) * (x * x) * x;
}

/// 1 - (1 - c/2)⁵ expanded, so that it keeps its digits at grazing angles.
double coat_transmission(double c) {
  const double h = c / 2;
  return h * (5 - h * (10 - h * (10 - h * (5 - h))));
}

}  // namespace

Rgb f(const FresnelBlend& lobe, const Vec3d& wo, const Vec3d& wi) {
  const double base =
      28 / (23 * std::numbers::pi) * coat_transmission(abs_cos(wi)) * coat_transmission(abs_cos(wo));
  const Vec3d wh = (wi + wo).normalized();
  const double cos_d = std::abs(wi ^ wh);
  const double coat = distribution(lobe.facets, wh) / (4 * cos_d * std::max(abs_cos(wi), abs_cos(wo)));
  const Rgb schlick =
      lobe.specular + (Rgb(1) - lobe.specular) * static_cast<float>(pow5(1 - std::min(cos_d, 1.0)));
  return lobe.diffuse * (Rgb(1) - lobe.specular) * static_cast<float>(base) +
         schlick * static_cast<float>(coat);
}

// Half of the samples go to the base, half to the coat, as in pbrt-v3.
double pdf(const FresnelBlend& lobe, const Vec3d& wo, const Vec3d& wi) {
  if (!same_hemisphere(wo, wi)) return 0;
  const Vec3d wh = (wo + wi).normalized();
  const double coat = distribution(lobe.facets, wh) * masking(lobe.facets, wo) / (4 * abs_cos(wo));
  return (cosine_hemisphere_pdf(abs_cos(wi)) + coat) / 2;
}

std::optional<Vec3d> sample(const FresnelBlend& lobe, const Vec3d& wo, const Vec2d& u) {
  if (u.x < 0.5) {
    Vec3d wi = square_to_cosine_hemisphere({2 * u.x, u.y});
    if (wo.z < 0) wi.z = -wi.z;
    return wi;
  }
  const Vec3d wi = reflected(wo, sample_visible_normal(lobe.facets, wo, {2 * u.x - 1, u.y}));
  if (!same_hemisphere(wo, wi)) return std::nullopt;
  return wi;
}

}  // namespace penumbra
