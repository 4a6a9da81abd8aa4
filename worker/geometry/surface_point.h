#pragma once
// One point of a surface with all that shading needs; world space.
#include <cmath>

#include "scenes/math.h"
#include "worker/geometry/geometry.h"

namespace penumbra {

struct SurfacePoint {
  Vec3f p;           ///< recomputed from barycentrics
  Vec3f p_error;     ///< bound of its rounding error, per component (pbrt-v3 §3.9)
  Vec3f ng;          ///< unit geometric normal, pbrt's orientation (emission side of area lights)
  Vec3f ns;          ///< unit shading normal, in ng's hemisphere
  Vec3f dpdu, dpdv;  ///< of the parametrisation uv
  Vec3f dndu, dndv;  ///< of the shading normal
  Vec2f uv;
  Vec3f dpdx, dpdy;  ///< per pixel footprint (already scaled for filtering); 0 if unknown
  float dudx = 0, dvdx = 0, dudy = 0, dvdy = 0;
  float front = 0, back = 0;  ///< how far matter reaches along ng and against it: a tube's own, else none
  Vec3f wo;                   ///< unit, towards the viewer
  PrimitiveId id;
  float time = 0;  ///< of the shutter, in [0,1]: when the point is there

  /// p moved off the surface to the side of `towards`, past its error bound (pbrt-v3 OffsetRayOrigin) and
  /// what matter there is.
  Vec3f offset(const Vec3f& towards) const;
};

}  // namespace penumbra
