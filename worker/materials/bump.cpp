#include "worker/materials/bump.h"

#include <cmath>

namespace penumbra {
namespace {

/// Half a pixel, so that the differences see what the texture's filter lets through; where the footprint is
/// unknown, pbrt's step: 1/2000 of the texture.
float step(float change_x, float change_y) {
  const float half_pixel = 0.5f * (std::abs(change_x) + std::abs(change_y));
  return half_pixel > 0 ? half_pixel : 0.0005f;
}

/// Replaces the frame, the normal kept on the geometric normal's side. A frame without area stays as it was.
SurfacePoint with_frame(const SurfacePoint& point, const Vec3f& dpdu, const Vec3f& dpdv,
                        const Vec3f& normal) {
  const float length = normal.length();
  if (!(length > 0) || !std::isfinite(length)) return point;
  SurfacePoint out = point;
  out.dpdu = dpdu;
  out.dpdv = dpdv;
  out.ns = normal / length;
  if ((out.ns ^ point.ng) < 0) out.ns = -out.ns;
  return out;
}

// p' = p + d n:  ∂p'/∂u = ∂p/∂u + ∂d/∂u n + d ∂n/∂u, and the same for v.
SurfacePoint bumped(const FloatValue& height, const SurfacePoint& point, const Textures& textures) {
  const float here = textures.evaluate(height, point);
  const auto slope = [&](const Vec2f& along, const Vec3f& dp, float du) {
    SurfacePoint shifted = point;
    shifted.p = point.p + dp * du;
    shifted.uv = point.uv + along * du;
    return (textures.evaluate(height, shifted) - here) / du;
  };
  const float by_u = slope({1, 0}, point.dpdu, step(point.dudx, point.dudy));
  const float by_v = slope({0, 1}, point.dpdv, step(point.dvdx, point.dvdy));
  const Vec3f dpdu = point.dpdu + point.ns * by_u + point.dndu * here;
  const Vec3f dpdv = point.dpdv + point.ns * by_v + point.dndv * here;
  return with_frame(point, dpdu, dpdv, dpdu % dpdv);
}

// pbrt-v4 §10.5.4: the texel is 2c - 1 in the frame (dpdu, n × dpdu, n).
SurfacePoint normal_mapped(const Image& map, const SurfacePoint& point) {
  const Rgb c = map.lookup(point.uv, Vec2f(0), Vec2f(0), {Wrap::kRepeat, Filter::kBilinear});
  const Vec3f in_frame(2 * c.x - 1, 2 * c.y - 1, 2 * c.z - 1);
  const Vec3f s = (point.dpdu - point.ns * (point.ns ^ point.dpdu)).normalized();
  const Vec3f t = point.ns % s;
  const Vec3f normal = (s * in_frame.x + t * in_frame.y + point.ns * in_frame.z).normalized();
  const float length = point.dpdu.length();
  const Vec3f dpdu = (point.dpdu - normal * (normal ^ point.dpdu)).normalized() * length;
  return with_frame(point, dpdu, normal % dpdu, normal);
}

}  // namespace

SurfacePoint displaced(const Material& material, const SurfacePoint& point, const Textures& textures) {
  if (material.normal_map != nullptr) return normal_mapped(*material.normal_map, point);
  return bumped(material.bump, point, textures);
}

}  // namespace penumbra
