#pragma once
// The point that is lit, as the strategies see it.
#include "worker/geometry/surface_point.h"
#include "worker/materials/bsdf.h"

namespace penumbra {

/// A point with what scatters there. Densities, shadow segments, lines and traced rays all start at the same
/// point x, so that they agree on what a direction means.
struct ShadingPoint {
  /// On a surface.
  ShadingPoint(const SurfacePoint& surface, const Bsdf& surface_bsdf)
      : scattering(surface_bsdf),
        bsdf(&surface_bsdf),
        wo(surface.wo),
        normal(surface.ng.dot(wo) < 0 ? -surface.ng : surface.ng),
        above(surface.offset(normal)),
        transmits(surface_bsdf.transmits()),
        time(surface.time) {
    below = transmits ? surface.offset(-normal) : above;
  }
  /// In a medium, away from every surface: no horizon.
  ShadingPoint(const Vec3f& p, const Vec3f& to_viewer, const Scattering& phase_function, float when = 0)
      : scattering(phase_function),
        wo(to_viewer),
        normal(0),
        above(p),
        below(p),
        transmits(false),
        time(when) {}

  const Scattering& scattering;
  const Bsdf* bsdf = nullptr;  ///< null in a medium
  Vec3f wo;
  Vec3f normal;  ///< unit geometric normal on the viewer's side: the horizon; 0 in a medium, which has none
  Vec3f above;   ///< the surface point moved off the surface to the viewer's side
  Vec3f below;   ///< … to the other side; equal to `above` where nothing is transmitted
  bool transmits;
  float time;  ///< of the shutter, in [0,1]: when light arrives

  /// Does light from one half of the directions not count?
  bool has_horizon() const { return bsdf != nullptr && !transmits; }

  /// Origin of what leaves towards `direction`.
  const Vec3f& origin(const Vec3f& direction) const { return direction.dot(normal) < 0 ? below : above; }

  /// scatter() without Lambert's lobes; on surfaces.
  Rgb scatter_beyond_lambertian(const Vec3f& wi) const {
    return bsdf->f_beyond_lambertian(wo, wi) * std::abs(wi.dot(bsdf->ns()));
  }

  /// BSDF × cosine towards wi, or phase function; sr⁻¹.
  Rgb scatter(const Vec3f& wi) const { return scattering.scatter(wo, wi); }
};

}  // namespace penumbra
