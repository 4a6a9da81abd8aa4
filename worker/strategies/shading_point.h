#pragma once
// The point that is lit, as the strategies see it.
#include "worker/geometry/surface_point.h"
#include "worker/materials/bsdf.h"

namespace penumbra {

/// A surface point with its scattering function. Densities, shadow segments, lines and traced rays all
/// start at the same point x, so that they agree on what a direction means.
struct ShadingPoint {
  ShadingPoint(const SurfacePoint& surface_point, const Bsdf& scattering)
      : surface(surface_point),
        bsdf(scattering),
        wo(surface_point.wo),
        normal(surface_point.ng.dot(wo) < 0 ? -surface_point.ng : surface_point.ng),
        above(surface_point.offset(normal)),
        transmits(scattering.transmits()) {
    below = transmits ? surface_point.offset(-normal) : above;
  }

  const SurfacePoint& surface;
  const Bsdf& bsdf;
  Vec3f wo;
  Vec3f normal;  ///< unit geometric normal on the viewer's side: the horizon
  Vec3f above;   ///< the surface point moved off the surface to the viewer's side
  Vec3f below;   ///< … to the other side; equal to `above` where nothing is transmitted
  bool transmits;

  /// Origin of what leaves towards `direction`.
  const Vec3f& origin(const Vec3f& direction) const { return direction.dot(normal) < 0 ? below : above; }

  /// scatter() without Lambert's lobes.
  Rgb scatter_beyond_lambertian(const Vec3f& wi) const {
    return bsdf.f_beyond_lambertian(wo, wi) * std::abs(wi.dot(bsdf.ns()));
  }

  /// BSDF × cosine towards wi, sr⁻¹.
  Rgb scatter(const Vec3f& wi) const { return bsdf.f(wo, wi) * std::abs(wi.dot(bsdf.ns())); }
};

}  // namespace penumbra
