#pragma once
// Where on a texture a surface point lies. The closed set of pbrt's two-dimensional mappings.
#include <variant>

#include "absl/status/statusor.h"
#include "scenes/description.h"
#include "scenes/math.h"
#include "worker/geometry/surface_point.h"

namespace penumbra {

/// What textures need of a surface point.
struct TexturePoint {
  Vec2f uv;
  Vec3f p;  ///< world
  Vec3f dpdx{0}, dpdy{0};
  Vec2f duvdx{0}, duvdy{0};

  TexturePoint(const Vec2f& at_uv, const Vec3f& at) : uv(at_uv), p(at) {}
  explicit TexturePoint(const SurfacePoint& s)
      : uv(s.uv), p(s.p), dpdx(s.dpdx), dpdy(s.dpdy), duvdx(s.dudx, s.dvdx), duvdy(s.dudy, s.dvdy) {}
};

/// Texture coordinates and their change from pixel to pixel.
struct TextureCoordinates {
  Vec2f st, dx{0}, dy{0};
};

/// st = scale uv + delta.
struct UvMapping {
  Vec2f scale{1}, delta{0};
};
/// Polar angle over π, azimuth over 2π, about the texture's origin.
struct SphericalMapping {
  Imath::M44f texture_from_world;
};
/// Azimuth over 2π (from -x), height on the unit sphere.
struct CylindricalMapping {
  Imath::M44f texture_from_world;
};
/// Projection onto two axes, world space.
struct PlanarMapping {
  Vec3f s_axis{1, 0, 0}, t_axis{0, 1, 0};
  Vec2f delta{0};
};

using Mapping2D = std::variant<UvMapping, SphericalMapping, CylindricalMapping, PlanarMapping>;

/// "mapping" "uv" | "spherical" | "cylindrical" | "planar" with their parameters.
absl::StatusOr<Mapping2D> make_mapping(const TextureEntity& entity, const SceneDescription& description);

TextureCoordinates map(const Mapping2D& mapping, const TexturePoint& point);

}  // namespace penumbra
